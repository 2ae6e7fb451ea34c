"""Made-up records of runs, for reports that are quick to make."""

import math
from itertools import pairwise

import pytest

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.il import Condition, ConditionType, Group, Mission
from argo_env.run.record import (
    Contact,
    PathSample,
    Reading,
    Result,
    RoundRun,
    TaskRun,
    TraceStep,
)
from argo_env.site import load_site
from tests.mission_writing import measure, way
from tests.yard import in_order, record_of

CORNERS = ((3.05, -2.55, 0.0), (8.0, -2.0, 0.0), (8.0, 1.5, 0.0), (1.4, 1.5, 0.0), (0.85, 3.5, 0.0))
STAIRS = ((0.85, 7.14, 2.5), (1.9, 7.8, 2.5), (1.9, 10.4, 2.5), (8.0, 10.4, 2.5))


@pytest.fixture(scope="session")
def site():
    return load_site("umad")


def along(corners, seconds, step=0.5):
    """Return samples along straight lines between the corners, at constant speed."""
    lengths = [math.dist(a, b) for a, b in pairwise(corners)]
    speed, samples, t = sum(lengths) / seconds, [], 0.0
    for (a, b), length in zip(pairwise(corners), lengths, strict=True):
        count = max(1, round(length / speed / step))
        for i in range(count):
            x, y, z = (p + i / count * (q - p) for p, q in zip(a, b, strict=True))
            yaw, floor = math.atan2(b[1] - a[1], b[0] - a[0]), 1 + int((z + 0.1) // 2.5)
            sample = PathSample(t=t, x=x, y=y, z=z, yaw=yaw, pitch=0.0, floor=floor)
            samples.append(sample)
            t += length / speed / count
    return tuple(samples)


@pytest.fixture
def make():
    """Return a function that makes a record with one run of 6 s for each name in `runs`.

    `outcomes` gives (outcome, reason) by number of the run; `changes` replaces fields.
    """

    def make(mission, runs, outcomes=None, path=(), **changes):
        tasks = tuple(
            TaskRun(
                task=name,
                action=mission.task(name).action,
                object_id=mission.task(name).object_id,
                start=6.0 * i,
                end=6.0 * i + 6.0,
                outcome=(outcomes or {}).get(i, ("done", None))[0],
                reason=(outcomes or {}).get(i, ("done", None))[1],
                distance=2.0,
                climbed=0.1,
            )
            for i, name in enumerate(runs)
        )
        trace = tuple(
            TraceStep(t=run.start, source=runs[i - 1] if i else None, target=run.task, cause="next")
            for i, run in enumerate(tasks)
        )
        fields = {
            "sensor": "geometric",
            "seed": 7,
            "result": Result(
                success=True,
                verdict="All checkpoints were read in time.",
                duration=6.0 * len(runs),
                max_duration=900.0,
                within_max_duration=True,
                docked=True,
                distance=2.0 * len(runs),
                climbed=2.5,
            ),
            "tasks": tasks,
            "trace": trace,
            "path": path,
        }
        return record_of(mission, **(fields | changes))

    return make


@pytest.fixture
def simple(make):
    """Record of a run on two floors.

    It has two readings, one of them abnormal, a failed task, a contact and a warning.
    """
    low = Condition(type=ConditionType.LESS, object_id="1", param1=3.0)
    tasks = (
        measure("1", way("6", low), "8"),
        measure("8", "6"),
        measure("6"),
    )
    mission = Mission(designation="Morning round", tasks=tasks)

    def reading(id, kind, value, normal, floor, t):
        return Reading(
            checkpoint=id,
            name=f"pressure gauge {id}",
            kind=kind,
            floor=floor,
            task=str(id),
            t=t,
            value=value,
            unit="bar",
            nominal=Interval(low=3.0, high=5.0),
            normal=normal,
            distance=1.2,
        )

    gauge = CheckpointKind.PRESSURE_GAUGE
    return make(
        mission,
        ["1", "8", "6"],
        {1: ("failed", "no view of it")},
        along(CORNERS + STAIRS, 18.0, 0.02),
        readings=(reading(1, gauge, 3.52, True, 1, 5.0), reading(6, gauge, 7.25, False, 2, 17.0)),
        contacts=(
            Contact(
                start=9.0,
                end=9.4,
                link="left track",
                element="west tower 1-2 flight handrails",
                x=0.6,
                y=4.0,
                z=0.4,
                depth=0.004,
            ),
        ),
        diagnostics=(
            Diagnostic(
                code="script.healed",
                severity=Severity.WARNING,
                message="read 'guage' as 'gauge'",
                hint="correct it",
            ),
        ),
    )


@pytest.fixture
def patrol(make):
    """Record of a group of four tasks, repeated 25 times in 600 s."""
    names = ["1", "3", "4", "2"]
    tasks = in_order(*map(measure, names))
    group = Group(name="Patrol", start="1", end="2", max_repeat_count=25, max_repeat_duration=600)
    mission = Mission(designation="Patrol", tasks=tasks, groups=(group,))
    ring = ((7.6, 1.6, 0.0), (12.3, 1.6, 0.0), (12.3, 10.4, 0.0), (1.9, 10.4, 0.0), (1.9, 1.6, 0.0))
    rounds = tuple(
        RoundRun(group="Patrol", number=k + 1, since=24.0 * k, began=24.0 * k) for k in range(25)
    )
    return make(mission, names * 25, path=along(ring * 25, 600.0, 0.05), rounds=rounds)
