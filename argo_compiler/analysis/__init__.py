"""Static analysis of a mission over all execution paths: reachability, duration and energy.

In this package, a leaf is a state of the mission's machine that executes one task, and a path is an
execution path, unless the robot's drive is meant. Leaves, groups and nodes are given by numbers
(see `flow`).
"""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "Analysis",
    "Bound",
    "Bounds",
    "GroupFacts",
    "Invariant",
    "KeptReading",
    "LeastSpent",
    "LeastWitness",
    "Leg",
    "NoPath",
    "ReadingScale",
    "RobotPose",
    "Stretch",
    "TaskFacts",
    "TransitionFacts",
    "Trap",
    "Travel",
    "Verdict",
    "Witnesses",
    "analyse",
    "unproved",
    "unproved_bounds",
]

if TYPE_CHECKING:
    from argo_compiler.analysis.analysing import analyse
    from argo_compiler.analysis.bound_verification import unproved_bounds
    from argo_compiler.analysis.results import (
        Analysis,
        Bound,
        Bounds,
        GroupFacts,
        Stretch,
        TaskFacts,
        TransitionFacts,
        Verdict,
    )
    from argo_compiler.analysis.travel import Leg, NoPath, RobotPose, Travel
    from argo_compiler.analysis.verification_claims import unproved
    from argo_compiler.analysis.witness import (
        Invariant,
        KeptReading,
        LeastSpent,
        LeastWitness,
        ReadingScale,
        Trap,
        Witnesses,
    )
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "analysing": ["analyse"],
            "bound_verification": ["unproved_bounds"],
            "results": [
                "Analysis",
                "Bound",
                "Bounds",
                "GroupFacts",
                "Stretch",
                "TaskFacts",
                "TransitionFacts",
                "Verdict",
            ],
            "travel": ["Leg", "NoPath", "RobotPose", "Travel"],
            "verification_claims": ["unproved"],
            "witness": [
                "Invariant",
                "KeptReading",
                "LeastSpent",
                "LeastWitness",
                "ReadingScale",
                "Trap",
                "Witnesses",
            ],
        },
    )
