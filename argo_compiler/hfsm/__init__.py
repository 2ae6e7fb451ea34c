"""The executable form of a mission: a hierarchical state machine, and what drives it."""

from argo_compiler.hfsm.conditions import Measured
from argo_compiler.hfsm.events import (
    ActionFailed,
    ActionSucceeded,
    CancelAction,
    Cause,
    Command,
    Event,
    StartAction,
    Tick,
    TraceEntry,
)
from argo_compiler.hfsm.executor import Executor
from argo_compiler.hfsm.lower import lower
from argo_compiler.hfsm.mermaid import to_mermaid
from argo_compiler.hfsm.model import Composite, Hfsm, Leaf, Repeat, Transition, TransitionKind
from argo_compiler.hfsm.progress import Progress

__all__ = [
    "ActionFailed",
    "ActionSucceeded",
    "CancelAction",
    "Cause",
    "Command",
    "Composite",
    "Event",
    "Executor",
    "Hfsm",
    "Leaf",
    "Measured",
    "Progress",
    "Repeat",
    "StartAction",
    "Tick",
    "TraceEntry",
    "Transition",
    "TransitionKind",
    "lower",
    "to_mermaid",
]
