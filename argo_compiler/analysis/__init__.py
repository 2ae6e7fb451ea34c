"""The analysis of a mission over all its paths: what can't happen, and what it takes."""

from argo_compiler.analysis.analyse import analyse
from argo_compiler.analysis.facts import (
    Analysis,
    Bound,
    Bounds,
    GroupFacts,
    Stretch,
    TaskFacts,
    TransitionFacts,
    Verdict,
)
from argo_compiler.analysis.travel import Leg, NoWay, Standing, Travel

__all__ = [
    "Analysis",
    "Bound",
    "Bounds",
    "GroupFacts",
    "Leg",
    "NoWay",
    "Standing",
    "Stretch",
    "TaskFacts",
    "TransitionFacts",
    "Travel",
    "Verdict",
    "analyse",
]
