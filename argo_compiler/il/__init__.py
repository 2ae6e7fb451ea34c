"""The intermediate language: missions as data, and what their tasks and groups are made of."""

from argo_compiler.il.mission import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Order,
    Reaction,
    Response,
    Stop,
    Task,
    Transition,
)

__all__ = [
    "Action",
    "Afterwards",
    "Condition",
    "ConditionType",
    "EventKind",
    "Group",
    "JointState",
    "Mission",
    "Mode",
    "OnFailure",
    "Order",
    "Reaction",
    "Response",
    "Stop",
    "Task",
    "Transition",
]
