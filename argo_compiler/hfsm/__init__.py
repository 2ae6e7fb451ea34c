"""Hierarchical state machine of a mission, and the executor that runs it."""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "ActionFailed",
    "ActionStopped",
    "ActionSucceeded",
    "AwaitedCharge",
    "ByHand",
    "Cancel",
    "CancelAction",
    "Cause",
    "CheckpointReading",
    "Command",
    "Composite",
    "EndedVisit",
    "Event",
    "Executor",
    "GiveBack",
    "Hfsm",
    "Leaf",
    "Measured",
    "Occurred",
    "Outcome",
    "Pause",
    "Progress",
    "ReactionState",
    "ReadingGiven",
    "ReadingKind",
    "ReadingProgress",
    "RepeatRule",
    "Resume",
    "StartAction",
    "StateTransition",
    "TakeOver",
    "TaskTally",
    "Tick",
    "TraceEntry",
    "TransitionKind",
    "lower",
]

if TYPE_CHECKING:
    from argo_compiler.hfsm.charging import AwaitedCharge
    from argo_compiler.hfsm.conditions import CheckpointReading, Measured
    from argo_compiler.hfsm.events import (
        ActionFailed,
        ActionStopped,
        ActionSucceeded,
        Cancel,
        CancelAction,
        Command,
        Event,
        GiveBack,
        Occurred,
        Pause,
        ReadingGiven,
        Resume,
        StartAction,
        TakeOver,
        Tick,
    )
    from argo_compiler.hfsm.executor import EndedVisit, Executor
    from argo_compiler.hfsm.kinds import Cause, Outcome, ReadingKind
    from argo_compiler.hfsm.lowering import lower
    from argo_compiler.hfsm.model import (
        Composite,
        Hfsm,
        Leaf,
        ReactionState,
        RepeatRule,
        StateTransition,
        TransitionKind,
    )
    from argo_compiler.hfsm.progress import (
        ByHand,
        Progress,
        ReadingProgress,
        TaskTally,
    )
    from argo_compiler.hfsm.trace import TraceEntry
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "charging": ["AwaitedCharge"],
            "conditions": ["CheckpointReading", "Measured"],
            "events": [
                "ActionFailed",
                "ActionStopped",
                "ActionSucceeded",
                "Cancel",
                "CancelAction",
                "Command",
                "Event",
                "GiveBack",
                "Occurred",
                "Pause",
                "ReadingGiven",
                "Resume",
                "StartAction",
                "TakeOver",
                "Tick",
            ],
            "executor": ["EndedVisit", "Executor"],
            "kinds": ["Cause", "Outcome", "ReadingKind"],
            "lowering": ["lower"],
            "model": [
                "Composite",
                "Hfsm",
                "Leaf",
                "ReactionState",
                "RepeatRule",
                "StateTransition",
                "TransitionKind",
            ],
            "progress": ["ByHand", "Progress", "ReadingProgress", "TaskTally"],
            "trace": ["TraceEntry"],
        },
    )
