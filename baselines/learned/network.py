"""The network: attention over checkpoints, with travel times and precedence between them.

It sees what `RouteEnv` with `full=True` observes. Nothing in it depends on how many checkpoints
there are or on their order, so the same weights serve any number of them. What is left of a route
is a smaller route problem from here with the time that is left: all times are taken as shares of
that, and what was visited, or can no longer be, is left out.
"""

from collections.abc import Mapping

import torch
from torch import Tensor, nn

from argo_env.envs.route_instance import DOCK
from baselines.learned.outlook import RULES, look_ahead

WIDTH, HEADS, LAYERS = 64, 4, 3
_NODE, _PAIR, _PAIR_WIDTH = 16 + 2 * RULES + 2, 8, 16
_FAR = 2.0  # shares of the time left; what is farther off makes no difference
_LEAST = 1e-3  # of the budget, so that nothing is divided by 0
_CLOSED = -1e9


class RouteNetwork(nn.Module):
    """Gives each node a score as the next one, and the chance that it will be visited at all."""

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
        """Logits of the next node, shape (batch, n + 1), not masked; and the prize that is still to
        come, shape (batch, 1)."""
        scores, visited, worth = self.scores(observation)
        return scores, (worth * torch.sigmoid(visited)).sum(dim=1, keepdim=True)

    def scores(self, observation: Mapping[str, Tensor]) -> tuple[Tensor, Tensor, Tensor]:
        """The logits of the next node; those of being visited at all; and what is to be had there,
        0 where it is out of reach. Each of shape (batch, n + 1)."""
        nodes, pairs, open_, worth = features(observation)
        x = self.node(nodes)
        batch, size = open_.shape
        bias = self.pair(pairs).view(batch, size, size, len(self.layers), -1).permute(3, 0, 4, 1, 2)
        bias = bias + torch.where(open_, 0.0, _CLOSED)[:, None, None, :]
        for layer, own in zip(self.layers, bias.flatten(1, 2), strict=True):
            x = layer(x, own)
        scores, visited = self.head(self.norm(x)).unbind(dim=2)
        return scores, visited, worth


class _Layer(nn.Module):
    """Attention among the nodes, then two dense layers at each of them."""

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
        batch, size, width = x.shape
        asked = self.ask(self.before_attention(x)).view(batch, size, 3, self.heads, -1)
        query, key, value = asked.permute(2, 0, 3, 1, 4).flatten(
            1, 2
        )  # (batch * heads, size, part)
        weights = torch.baddbmm(bias, query, key.transpose(1, 2), alpha=key.shape[2] ** -0.5)
        mixed = (weights.softmax(dim=2) @ value).view(batch, self.heads, size, -1)
        x = x + self.answer(mixed.transpose(1, 2).reshape(batch, size, width))
        x = x + self.dense(self.before_dense(x))
        return x


def features(observation: Mapping[str, Tensor]) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """What the network sees of each node, shape (batch, n + 1, 24), and of each pair, shape
    (batch, n + 1, n + 1, 8); which nodes are still open; and the prizes that are to be had."""
    prize, left = observation["prize"].float(), observation["left"].float().clamp_min(_LEAST)
    size = prize.shape[1]
    legal = observation["mask"].bool()
    before = observation["before"].float()
    here = observation["travel"].float() / left
    home = observation["home"].float() / left
    between = observation["matrix"][:, :size].float() / left[:, :, None]

    dock = torch.zeros(size, dtype=torch.bool, device=prize.device)
    dock[DOCK] = True
    waiting = (prize > 0) & ~dock
    open_ = _still_open(waiting, here + home, before) | (legal & ~dock)
    share = open_.float()
    worth = prize * share
    count = share.sum(dim=1, keepdim=True).clamp_min(1.0)
    mean = worth.sum(dim=1, keepdim=True) / count + 1e-6

    choices = legal & ~dock
    won, spare = look_ahead(choices, waiting, prize, here, home, between, before)
    ahead = _ahead(won, spare, worth, mean) * choices[:, :, None]

    here, home, between = here.clamp_max(_FAR), home.clamp_max(_FAR), between.clamp_max(_FAR)
    itself = torch.eye(size, dtype=torch.bool, device=prize.device)
    shut = itself | ~open_[:, None] | ~open_[:, :, None]
    apart = between.masked_fill(shut, _FAR)
    # To a checkpoint one comes from another one or from here.
    nearest_in = torch.minimum(apart.amin(dim=1), here)
    nearest_out = torch.minimum(apart.amin(dim=2), home)
    later = torch.minimum(apart.amin(dim=1), torch.full_like(here, _FAR))
    mean_in = (between.masked_fill(shut, 0.0).sum(dim=1)) / count
    unlocked = (before @ worth[:, :, None])[:, :, 0]
    unlocked = unlocked + (before @ (unlocked * share)[:, :, None])[:, :, 0]
    tightness = (nearest_in * share).sum(dim=1, keepdim=True).clamp_max(4.0)
    every = torch.ones_like(here)
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
            worth / mean * 0.5,
            worth,
            unlocked / mean * 0.5,
            (share[:, None] @ before)[:, 0],  # how many come before it
            legal.float(),
            dock.float() * every,
            tightness * every,
            count.log() * 0.25 * every,
        ],
        dim=2,
    )
    nodes = torch.cat([nodes, ahead], dim=2) * (open_ | dock)[:, :, None]
    return nodes, _pairs(here, home, between, before), open_ | dock, worth


def _still_open(waiting: Tensor, there_and_home: Tensor, before: Tensor) -> Tensor:
    """Which of those that wait can be made within what is left, with what comes before them."""
    open_ = waiting & (there_and_home <= 1.0 + 1e-5)
    for _ in range(2):  # what waits for a checkpoint that is out of reach is so too
        lost = (waiting & ~open_).float()
        open_ = open_ & ((lost[:, None] @ before)[:, 0] == 0)
    return open_


def _ahead(won: Tensor, spare: Tensor, worth: Tensor, mean: Tensor) -> Tensor:
    """What looking ahead says of each node."""
    best = won.amax(dim=2)
    ahead = torch.cat(
        [
            (won - won.amax(dim=1, keepdim=True)) / mean[:, :, None],
            spare,
            ((best - best.amax(dim=1, keepdim=True)) / mean)[:, :, None],
            (best / worth.sum(dim=1, keepdim=True).clamp_min(1e-6))[:, :, None],
        ],
        dim=2,
    )
    return ahead.clamp(-_FAR, _FAR)


def _pairs(here: Tensor, home: Tensor, between: Tensor, before: Tensor) -> Tensor:
    """What is seen of each pair of nodes."""
    back = between.transpose(1, 2)
    return torch.stack(
        [
            between * 2,
            back * 2,
            between.sqrt(),
            back.sqrt(),
            here[:, :, None] + between - here[:, None],  # more than straight there from here
            between + home[:, None] - home[:, :, None],  # more than straight home
            before,
            before.transpose(1, 2),
        ],
        dim=3,
    )
