"""Network with attention over checkpoints, and travel times and precedence between them.

Its input is an observation of `RouteEnv` with `full=True`. Its weights do not depend on the number
of checkpoints or on their order, so the same weights serve any number of them. The rest of a route
is a smaller route problem, from the robot's node with the time that is left. So all times are
shares of the time left, and nodes that were visited or can't be visited any more are left out.
"""

from collections.abc import Mapping

import torch
from torch import Tensor, nn

from argo_env.envs.route_instance import DOCK
from baselines.learned.look_ahead import RULES, rule_prizes_and_times_left

WIDTH, HEADS, LAYERS = 64, 4, 3
_NODE, _PAIR, _PAIR_WIDTH = 16 + 2 * RULES + 2, 8, 16
_FAR = 2.0  # multiple of the time left; longer times make no difference
_MIN_LEFT = 1e-3  # share of the budget, to avoid a division by 0
_MASKED = -1e9  # attention bias of nodes that are not open


class RouteNetwork(nn.Module):
    """Network that scores each node as the next one and predicts whether it will be visited."""

    def __init__(self, width: int = WIDTH, heads: int = HEADS, layers: int = LAYERS) -> None:
        super().__init__()
        self.node = nn.Linear(_NODE, width)
        self.pair = nn.Sequential(
            nn.Linear(_PAIR, _PAIR_WIDTH), nn.GELU(), nn.Linear(_PAIR_WIDTH, heads * layers)
        )
        self.layers = nn.ModuleList(_Layer(width, heads) for _ in range(layers))
        self.norm = nn.LayerNorm(width)
        self.head = nn.Linear(width, 2)

    def forward(self, observation: Mapping[str, Tensor]) -> tuple[Tensor, Tensor]:
        """Return logits of the next node and the value of the state.

        Returns:
            Logits, shape (batch, n + 1), not masked; and the expected prize that will still be won,
            shape (batch, 1).
        """
        scores, visited, prizes = self.next_and_visit_logits_and_prizes(observation)
        return scores, (prizes * torch.sigmoid(visited)).sum(dim=1, keepdim=True)

    def next_and_visit_logits_and_prizes(
        self, observation: Mapping[str, Tensor]
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Return the outputs for each node.

        Returns:
            Logits of being the next node; logits of being visited at all; and the prize that can be
            won, 0 at nodes out of reach. Each has the shape (batch, n + 1).
        """
        nodes, pairs, open_, prizes = network_inputs(observation)
        x = self.node(nodes)
        batch, size = open_.shape
        bias = self.pair(pairs).view(batch, size, size, len(self.layers), -1).permute(3, 0, 4, 1, 2)
        bias = bias + torch.where(open_, 0.0, _MASKED)[:, None, None, :]
        for layer, layer_bias in zip(self.layers, bias.flatten(1, 2), strict=True):
            x = layer(x, layer_bias)
        scores, visited = self.head(self.norm(x)).unbind(dim=2)
        return scores, visited, prizes


class _Layer(nn.Module):
    """Layer of attention among the nodes, followed by two dense layers for each node."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.before_attention = nn.LayerNorm(width)
        self.ask = nn.Linear(width, 3 * width)
        self.answer = nn.Linear(width, width)
        self.before_dense = nn.LayerNorm(width)
        self.dense = nn.Sequential(
            nn.Linear(width, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )

    def forward(self, x: Tensor, bias: Tensor) -> Tensor:
        """Return the new state of each node; `bias` is added to the attention of each pair."""
        batch, size, width = x.shape
        projected = self.ask(self.before_attention(x)).view(batch, size, 3, self.heads, -1)
        # Each has the shape (batch * heads, size, width / heads).
        query, key, value = projected.permute(2, 0, 3, 1, 4).flatten(1, 2)
        weights = torch.baddbmm(bias, query, key.transpose(1, 2), alpha=key.shape[2] ** -0.5)
        mixed = (weights.softmax(dim=2) @ value).view(batch, self.heads, size, -1)
        x = x + self.answer(mixed.transpose(1, 2).reshape(batch, size, width))
        x = x + self.dense(self.before_dense(x))
        return x


def network_inputs(
    observation: Mapping[str, Tensor],
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Compute the inputs of the network from an observation.

    Returns:
        Features of each node, shape (batch, n + 1, 24); features of each pair of nodes, shape
        (batch, n + 1, n + 1, 8); which nodes are open, the dock included, shape (batch, n + 1);
        and the prizes that can still be won, 0 at nodes out of reach, shape (batch, n + 1).
    """
    prize, left = observation["prize"].float(), observation["left"].float().clamp_min(_MIN_LEFT)
    size = prize.shape[1]
    legal = observation["mask"].bool()
    before = observation["before"].float()
    here = observation["travel"].float() / left
    home = observation["home"].float() / left
    between = observation["matrix"][:, :size].float() / left[:, :, None]

    dock = torch.zeros(size, dtype=torch.bool, device=prize.device)
    dock[DOCK] = True
    unvisited = (prize > 0) & ~dock
    open_ = _reachable(unvisited, here + home, before) | (legal & ~dock)
    is_open = open_.float()
    prizes = prize * is_open
    count = is_open.sum(dim=1, keepdim=True).clamp_min(1.0)
    mean = prizes.sum(dim=1, keepdim=True) / count + 1e-6

    choices = legal & ~dock
    won, spare = rule_prizes_and_times_left(choices, unvisited, prize, here, home, between, before)
    ahead = _look_ahead_features(won, spare, prizes, mean) * choices[:, :, None]

    here, home, between = here.clamp_max(_FAR), home.clamp_max(_FAR), between.clamp_max(_FAR)
    itself = torch.eye(size, dtype=torch.bool, device=prize.device)
    excluded = itself | ~open_[:, None] | ~open_[:, :, None]
    times = between.masked_fill(excluded, _FAR)
    # The robot reaches a checkpoint from another one or from its own node.
    nearest_in = torch.minimum(times.amin(dim=1), here)
    nearest_out = torch.minimum(times.amin(dim=2), home)
    later = torch.minimum(times.amin(dim=1), torch.full_like(here, _FAR))
    mean_in = (between.masked_fill(excluded, 0.0).sum(dim=1)) / count
    unlocked = (before @ prizes[:, :, None])[:, :, 0]
    unlocked = unlocked + (before @ (unlocked * is_open)[:, :, None])[:, :, 0]
    tightness = (nearest_in * is_open).sum(dim=1, keepdim=True).clamp_max(4.0)
    ones = torch.ones_like(here)
    nodes = torch.stack(
        [
            here * 2,
            here.sqrt(),
            home * 2,
            1.0 - here - home,
            nearest_in * 4,
            nearest_out * 4,
            (here - later) * 2,
            mean_in * 2,
            prizes / mean * 0.5,
            prizes,
            unlocked / mean * 0.5,
            (is_open[:, None] @ before)[:, 0],  # number of open nodes that must come before it
            legal.float(),
            dock.float() * ones,
            tightness * ones,
            count.log() * 0.25 * ones,
        ],
        dim=2,
    )
    nodes = torch.cat([nodes, ahead], dim=2) * (open_ | dock)[:, :, None]
    return nodes, _pair_features(here, home, between, before), open_ | dock, prizes


def _reachable(unvisited: Tensor, there_and_home: Tensor, before: Tensor) -> Tensor:
    """Return the unvisited nodes that may still be reached in the time left.

    A node counts as out of reach if the time there and home is too long, or if a node is out of
    reach that must come before it, directly or with one node between them.
    """
    open_ = unvisited & (there_and_home <= 1.0 + 1e-5)
    for _ in range(2):
        lost = (unvisited & ~open_).float()
        open_ = open_ & ((lost[:, None] @ before)[:, 0] == 0)
    return open_


def _look_ahead_features(won: Tensor, spare: Tensor, prizes: Tensor, mean: Tensor) -> Tensor:
    """Return the features of each node that result from looking ahead."""
    best = won.amax(dim=2)
    ahead = torch.cat(
        [
            (won - won.amax(dim=1, keepdim=True)) / mean[:, :, None],
            spare,
            ((best - best.amax(dim=1, keepdim=True)) / mean)[:, :, None],
            (best / prizes.sum(dim=1, keepdim=True).clamp_min(1e-6))[:, :, None],
        ],
        dim=2,
    )
    return ahead.clamp(-_FAR, _FAR)


def _pair_features(here: Tensor, home: Tensor, between: Tensor, before: Tensor) -> Tensor:
    """Return the features of each pair of nodes."""
    back = between.transpose(1, 2)
    return torch.stack(
        [
            between * 2,
            back * 2,
            between.sqrt(),
            back.sqrt(),
            here[:, :, None] + between - here[:, None],  # detour via the first to the second
            between + home[:, None] - home[:, :, None],  # detour via the second to the dock
            before,
            before.transpose(1, 2),
        ],
        dim=3,
    )
