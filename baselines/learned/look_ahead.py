"""Look-ahead: the prizes that greedy rules would still win after each of the next nodes.

Each rule chooses the node with the highest quotient of a power of its prize and the time there,
until no node fits any more. All is computed from the observation, for a batch of states at once.
"""

import torch
from torch import Tensor

POWERS = (0.0, 0.5, 1.0)
"""power of the prize in each rule; 0 is the nearest neighbour"""
RULES = len(POWERS)
"""number of rules"""
_SHORT = 0.01  # share of the time left, added to all times so that none is 0
_ROUNDING = 1e-6  # share of the time left, tolerance of the time limit
_TIE = 1e-4  # weight of the prize that decides between nodes with equal scores


@torch.no_grad()
def rule_prizes_and_times_left(
    legal: Tensor, unvisited: Tensor, prize: Tensor, here: Tensor, home: Tensor, between: Tensor,
    before: Tensor,
) -> tuple[Tensor, Tensor]:  # fmt: skip
    """Simulate each rule after each legal node, until no node fits any more.

    Times are shares of the time left. `between` and `before` have the shape (batch, n + 1, n + 1),
    the other arguments (batch, n + 1).

    Args:
        legal: legal nodes, without the dock.
        unvisited: nodes that are not visited yet.
        prize: prize of each node.
        here: time from the robot's node to each node.
        home: time from each node to the dock.
        between: time from one node (row) to another.
        before: 1 where row must be visited before column.

    Returns:
        The prize that each rule wins if the node is next, and the time that it has left at its last
        node, where the drive to the dock is still to be paid. Each has the shape
        (batch, n + 1, rules); 0 for nodes that are not legal.
    """
    batch, size = prize.shape
    state, first = legal.nonzero(as_tuple=True)
    count = len(state)
    powers = torch.tensor(POWERS)[:, None, None, None]
    rating = powers * prize.clamp_min(1e-6).log()[:, None] - (between + _SHORT).log()
    # Equal times are common: the greater prize decides, so the order of the nodes does not matter.
    rating = (rating + _TIE * prize[:, None]).reshape(RULES * batch * size, size)
    need = (between + home[:, None]).reshape(batch * size, size)
    flat = before.reshape(batch * size, size)

    state, place = state.repeat(RULES), first.repeat(RULES)
    rule = torch.arange(RULES).repeat_interleave(count)
    rows = torch.arange(RULES * count)
    row = state * size
    rule_row = rule * (batch * size) + row
    missing = (unvisited.float()[:, None] @ before)[:, 0][state] - flat[row + place]
    open_ = unvisited[state]
    open_[rows, place] = False
    won, left = prize[state, place], 1.0 - here[state, place]
    while len(rows):
        at = row + place
        fits = (need[at] <= left[:, None] - _ROUNDING) & open_ & (missing < 0.5)
        score, best = rating[rule_row + place].masked_fill(~fits, -torch.inf).max(dim=1)
        going = score > -torch.inf
        if not bool(going.any()):
            break
        took = torch.where(going, between.reshape(-1, size)[at, best], 0.0)
        left = left - took
        won = won + torch.where(going, prize[state, best], 0.0)
        missing = missing - flat[row + best] * going[:, None]
        open_[rows, best] &= ~going
        place = torch.where(going, best, place)
    result = torch.zeros(2, batch, size, RULES)
    result[0, state, first.repeat(RULES), rule] = won
    result[1, state, first.repeat(RULES), rule] = left
    return result[0], result[1]
