"""Scores: how well runs went by the criteria of a competition. What is known of them, and what is
assumed, stands in one file, which may be replaced: `scenarios/scoring.yaml`."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import Field, model_validator

from argo_compiler.base.model import Model
from argo_compiler.files.loading import decode_text, read_bytes
from argo_env.evaluation.estimates.pairs import difference
from argo_env.evaluation.estimates.rates import Estimate, world_means
from argo_env.evaluation.row import RunRow
from argo_env.files import resources
from argo_env.files.yaml_file import parse_yaml

_MAX_BYTES = 100_000
_Rules = TypeVar("_Rules", bound=Model)


class ReliabilityRules(Model):
    """What the mission was to do."""

    weight: float = Field(ge=0)
    """points"""
    tasks_done: float = Field(ge=0, le=1)
    success: float = Field(ge=0, le=1)

    @model_validator(mode="after")
    def _whole(self) -> "ReliabilityRules":
        return _require_whole(self, self.tasks_done, self.success)


class RobustnessRules(Model):
    """What goes wrong is found, and the mission copes with it."""

    weight: float = Field(ge=0)
    """points"""
    detected: float = Field(ge=0, le=1)
    no_false_alarm: float = Field(ge=0, le=1)
    goes_on: float = Field(ge=0, le=1)

    @model_validator(mode="after")
    def _whole(self) -> "RobustnessRules":
        return _require_whole(self, self.detected, self.no_false_alarm, self.goes_on)


class SafetyRules(Model):
    """Nothing is touched."""

    weight: float = Field(ge=0)
    """points"""
    contact: float = Field(ge=0, le=1)
    """share that is lost with each contact"""
    mishap: float = Field(ge=0, le=1)
    """share that is lost with each slip, fall or stall"""


class ScoringRules(Model):
    """How runs are scored, from 0 to the sum of the weights."""

    reliability: ReliabilityRules
    robustness: RobustnessRules
    safety: SafetyRules

    @property
    def most(self) -> float:
        """Points that can be had."""
        return self.reliability.weight + self.robustness.weight + self.safety.weight


class RunScore(Model):
    """The points of a run."""

    reliability: float
    robustness: float
    safety: float

    @property
    def total(self) -> float:
        return self.reliability + self.robustness + self.safety


def score_of(row: RunRow, rules: ScoringRules) -> RunScore:
    """The points of a run; of one that could not be carried out, none."""
    if not row.carried_out:
        return RunScore(reliability=0.0, robustness=0.0, safety=0.0)
    # Of a mission with branches some tasks are not to be done.
    done = 1.0 if row.success or not row.tasks else row.done / row.tasks
    reliable, robust, safe = rules.reliability, rules.robustness, rules.safety
    found = sum(one.delay is not None for one in row.detections)
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
    """The mean over runs that were carried out, with an interval of 95 % by the bootstrap over
    worlds, as the runs of one world depend on each other."""
    means = world_means((row.seed, score_of(row, rules).total) for row in rows if row.carried_out)
    if not len(means):
        return Estimate(math.nan, math.nan, math.nan)
    found = difference(means, np.zeros(len(means)))
    return Estimate(found.value, found.low, found.high)


def read_scoring(path: Path | None = None) -> ScoringRules:
    """The rules in a YAML file, those that Argo ships if none is named.

    Raises ArgoError if it can't be read, and DiagnosticError, with the place, if it holds none.
    """
    file = path or resources.scenarios() / "scoring.yaml"
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


def _require_whole(rules: _Rules, *shares: float) -> _Rules:
    whole = math.fsum(shares)
    if abs(whole - 1.0) > 1e-9:
        raise ValueError(f"the shares of a criterion add up to {whole:g}, and must to 1")
    return rules
