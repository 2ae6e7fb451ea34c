"""Names of tasks that the machine adds; no task of a mission may have one of them."""

from argo_compiler.base.message import Message
from argo_compiler.il.events import EventKind

RETURN_TASK = Message("return to dock")
"""the drive back to the dock after a failure"""


def reaction_task_name(event: str) -> str:
    """Return the name of the drive of the reaction to an event."""
    return Message("react to {event}", event=event)


RESERVED_NAMES = frozenset([RETURN_TASK, *(reaction_task_name(event) for event in EventKind)])
