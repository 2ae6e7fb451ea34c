"""Time-outs of groups: the transition that the machine takes when the time of a group is up.

With a hard stop the machine leaves the group at once, by the transition that is made here:
`configuration.py` computes when it is due by the group's clock, and `machine_state.py` takes it.
With a soft stop the present round continues to its end, and `configuration.py` starts no other.
"""

from argo_compiler.hfsm.model import StateTransition, TransitionKind, group_id
from argo_compiler.il import Group


def hard_stop_transition(group: Group) -> StateTransition | None:
    """Return the transition that leaves a group when its time is up, or None without a hard stop.

    The transition completes the group: what follows the group is next, as after its last round.
    """
    if not group.has_hard_stop:
        return None
    return StateTransition(kind=TransitionKind.TIMEOUT, completes=group_id(group.name))
