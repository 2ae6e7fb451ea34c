"""A look ahead: what simple rules would still bring after each of the next nodes.

Each rule goes to the node with the highest power of the prize over the time there, until nothing
fits any more. It is computed from what the network observes, for a batch of states at once.
"""

import torch
from torch import Tensor

POWERS = (0.0, 0.5, 1.0)
"""of the prize; 0 is the nearest neighbour"""
RULES = len(POWERS)
_SHORT = 0.01  # of the time left, added to all times, so that none is 0
_ROUNDING = 1e-6
_TIE = 1e-4


@torch.no_grad()
def look_ahead(
    legal: Tensor, waiting: Tensor, prize: Tensor, here: Tensor, home: Tensor, between: Tensor,
    before: Tensor,
) -> tuple[Tensor, Tensor]:  # fmt: skip
    """The prize that each rule has collected in the end, and the time that it has left, if the node
    is taken first; each of shape (batch, n + 1, rules), 0 for nodes that are not legal.

    Times are shares of the time left. `legal` is without the dock, `waiting` what was not visited;
    `between` and `before` have shape (batch, n + 1, n + 1), the others (batch, n + 1).
    """
    batch, size = prize.shape
    state, first = legal.nonzero(as_tuple=True)
    count = len(state)
    powers = torch.tensor(POWERS)[:, None, None, None]
    pull = powers * prize.clamp_min(1e-6).log()[:, None] - (between + _SHORT).log()
    # Equal times are common: of those the greater prize, whatever the order of the nodes.
    pull = (pull + _TIE * prize[:, None]).reshape(RULES * batch * size, size)
    need = (between + home[:, None]).reshape(batch * size, size)
    flat = before.reshape(batch * size, size)

    state, place = state.repeat(RULES), first.repeat(RULES)
    rule = torch.arange(RULES).repeat_interleave(count)
    rows = torch.arange(RULES * count)
    row = state * size
    rule_row = rule * (batch * size) + row
    missing = (waiting.float()[:, None] @ before)[:, 0][state] - flat[row + place]
    open_ = waiting[state]
    open_[rows, place] = False
    won, left = prize[state, place], 1.0 - here[state, place]
    while len(rows):
        at = row + place
        fits = (need[at] <= left[:, None] - _ROUNDING) & open_ & (missing < 0.5)
        score, best = pull[rule_row + place].masked_fill(~fits, -torch.inf).max(dim=1)
        going = score > -torch.inf
        if not bool(going.any()):
            break
        took = torch.where(going, between.reshape(-1, size)[at, best], 0.0)
        left = left - took
        won = won + torch.where(going, prize[state, best], 0.0)
        missing = missing - flat[row + best] * going[:, None]
        open_[rows, best] &= ~going
        place = torch.where(going, best, place)
    found = torch.zeros(2, batch, size, RULES)
    found[0, state, first.repeat(RULES), rule] = won
    found[1, state, first.repeat(RULES), rule] = left
    return found[0], found[1]
