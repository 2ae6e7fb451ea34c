"""Time-outs of groups: what the machine does when the time of a group is up.

With a hard stop the machine leaves the group at once, by the transition that is made here:
`configuration.py` finds when that is due by the group's clock, and `tasks_and_groups.py` takes the
transition. With a soft stop the round goes on to its end, and `configuration.py` begins no other.
"""

from argo_compiler.hfsm.model import StateTransition, TransitionKind, group_id
from argo_compiler.il import Group


def timeout_of(group: Group) -> StateTransition | None:
    """Return the transition by which a group is left when its time is up, or None if a round is
    never interrupted. It completes the group, as the end of its last round does."""
    if not group.ends_at_once:
        return None
    return StateTransition(kind=TransitionKind.TIMEOUT, completes=group_id(group.name))
