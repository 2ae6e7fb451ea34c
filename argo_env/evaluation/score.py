"""Scores of runs by the criteria of a competition.

The weights are in one file, `scenarios/scoring.yaml`, which can be replaced. It also says which of
them are known and which are assumed.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import Field, model_validator

from argo_compiler.base.model import Model
from argo_compiler.files.loading import decode_text, read_bytes
from argo_env.evaluation.estimates.pairs import mean_first_minus_second
from argo_env.evaluation.estimates.rates import Estimate, world_means_in_order_seen
from argo_env.evaluation.row import RunRow
from argo_env.files import resources
from argo_env.files.yaml_file import parse_yaml

_MAX_BYTES = 100_000
_Rules = TypeVar("_Rules", bound=Model)


class ReliabilityRules(Model):
    """Rules on completing the mission; its shares add up to 1."""

    weight: float = Field(ge=0)
    """points"""
    tasks_done: float = Field(ge=0, le=1)
    """share for tasks that are done"""
    success: float = Field(ge=0, le=1)
    """share for a successful mission"""

    @model_validator(mode="after")
    def _check_shares(self) -> "ReliabilityRules":
        return _require_sum_of_one(self, self.tasks_done, self.success)


class RobustnessRules(Model):
    """Rules on detecting faults and coping with them; its shares add up to 1."""

    weight: float = Field(ge=0)
    """points"""
    detected: float = Field(ge=0, le=1)
    """share for faults that the robot finds"""
    no_false_alarm: float = Field(ge=0, le=1)
    """share for a run without false findings and all-clears"""
    goes_on: float = Field(ge=0, le=1)
    """share for a robot that ends in its dock, or whose mission requires no dock"""

    @model_validator(mode="after")
    def _check_shares(self) -> "RobustnessRules":
        return _require_sum_of_one(self, self.detected, self.no_false_alarm, self.goes_on)


class SafetyRules(Model):
    """Rules on contacts and mishaps."""

    weight: float = Field(ge=0)
    """points"""
    contact: float = Field(ge=0, le=1)
    """share lost with each contact"""
    mishap: float = Field(ge=0, le=1)
    """share lost with each slip, fall or stall"""


class ScoringRules(Model):
    """Rules that score a run, from 0 to the sum of the weights."""

    reliability: ReliabilityRules
    robustness: RobustnessRules
    safety: SafetyRules

    @property
    def max_score(self) -> float:
        """Largest possible score in points: the sum of the weights."""
        return self.reliability.weight + self.robustness.weight + self.safety.weight


class RunScore(Model):
    """Score of a run, in points."""

    reliability: float
    robustness: float
    safety: float

    @property
    def total(self) -> float:
        return self.reliability + self.robustness + self.safety


def score_run(row: RunRow, rules: ScoringRules) -> RunScore:
    """Compute the score of a run.

    It is 0 for a run that could not be carried out, and for a robot that stands with an empty
    battery: it is lost until a person fetches it.
    """
    if not row.is_completed or row.is_stranded:
        return RunScore(reliability=0.0, robustness=0.0, safety=0.0)
    # A successful mission with branches doesn't do all of its tasks.
    done = 1.0 if row.success or not row.tasks else row.done / row.tasks
    reliable, robust, safe = rules.reliability, rules.robustness, rules.safety
    found = sum(detection.delay is not None for detection in row.detections)
    detected = found / len(row.detections) if row.detections else 1.0
    lost = safe.contact * row.contacts + safe.mishap * row.mishaps
    return RunScore(
        reliability=reliable.weight * (reliable.tasks_done * done + reliable.success * row.success),
        robustness=robust.weight
        * (
            robust.detected * detected
            + robust.no_false_alarm * (row.false_alarms == 0)
            + robust.goes_on * (row.docked is not False)
        ),
        safety=safe.weight * max(0.0, 1.0 - lost),
    )


def mean_score(rows: Sequence[RunRow], rules: ScoringRules) -> Estimate:
    """Compute the mean score of the runs that were carried out, with a 95 % interval.

    The interval is that of the bootstrap over worlds, as the runs of one world depend on each
    other. All values are NaN if no run was carried out.
    """
    means = world_means_in_order_seen(
        (row.seed, score_run(row, rules).total) for row in rows if row.is_completed
    )
    if not len(means):
        return Estimate(math.nan, math.nan, math.nan)
    mean = mean_first_minus_second(means, np.zeros(len(means)))
    return Estimate(mean.value, mean.low, mean.high)


def read_scoring(path: Path | None = None) -> ScoringRules:
    """Read scoring rules from a YAML file; None for the rules that Argo ships.

    Raises ArgoError if the file can't be read, and DiagnosticError, with positions in the file, if
    it has no valid rules.
    """
    file = path or resources.scenarios_folder() / "scoring.yaml"
    content = read_bytes(file, "file of scoring rules", _MAX_BYTES)
    return parse_yaml(
        decode_text(content, str(file), "file of scoring rules"),
        str(file),
        ScoringRules,
        "scoring rules",
        not_yaml="evaluation.not-yaml",
        duplicate_key="evaluation.duplicate-key",
        wrong_field="evaluation.wrong-field",
    )


def _require_sum_of_one(rules: _Rules, *shares: float) -> _Rules:
    total = math.fsum(shares)
    if abs(total - 1.0) > 1e-9:
        raise ValueError(f"the shares of a criterion add up to {total:g}, but must add up to 1")
    return rules
