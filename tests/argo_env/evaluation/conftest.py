"""Shared fixtures and helpers of the tests of evaluations: a short mission, and plans with it."""

from collections.abc import Iterator
from importlib.util import find_spec

import pytest

from argo_compiler.il import Action, Mission, Task
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import make_backend
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, make_empty_row
from argo_env.planning.opening import open_site
from argo_env.run.spec import RunSpec
from tests.yard import from_place


def short_mission(limit: float | None = None) -> Mission:
    """Return a mission that measures one gauge of UMAD, from its first dock."""
    start = open_site("umad").site.docks[1]
    gauge = Task(name="GAUGE", action=Action.MEASURE, object_id="1")
    return from_place(start, gauge, max_duration=limit)


def plan_of(
    mission, seeds, faults=("none",), drive="route", name="m", given=(), **options
) -> EvaluationPlan:
    """Return a plan that evaluates the mission in these worlds.

    It has a case for each name in `faults`, which may map names to weights. The case `none` has no
    faults, all others have the faults `given`.
    """
    spec = RunSpec(mission=mission, drive=drive)
    faulty = spec.model_copy(update={"faults": given})
    weights = faults if isinstance(faults, dict) else dict.fromkeys(faults, 1.0)
    cases = tuple(
        EvaluationCase(
            mission=name,
            faults=faults_name,
            spec=spec if faults_name == "none" else faulty,
            weight=weight,
        )
        for faults_name, weight in weights.items()
    )
    return EvaluationPlan(cases=cases, seeds=tuple(seeds), **options)


def results_with(plan, change) -> EvaluationResults:
    """Return results of the plan; `change` gives, for each run, the fields to set in its row."""
    rows = []
    for run in plan.runs():
        row = make_empty_row("", plan.cases[run.case], run.spec, RunOutcome.SUCCESS, "")
        rows.append(row.model_copy(update={"seed": run.seed, **change(run)}))
    return EvaluationResults(plan, tuple(rows))


@pytest.fixture(scope="session")
def mission() -> Mission:
    return short_mission()


@pytest.fixture(scope="session")
def plan(mission) -> EvaluationPlan:
    """Return a plan with the short mission in ten worlds, by travel times."""
    return plan_of(mission, range(10), name="short")


PACKAGES = {"processes": "loky", "ray": "ray", "dask": "distributed"}
NEEDED = [
    pytest.param(
        name,
        marks=[
            *([pytest.mark.long] if name != "processes" else []),
            pytest.mark.skipif(
                find_spec(package) is None, reason=f"needs `{package}`: pip install '.[cluster]'"
            ),
        ],
    )
    for name, package in PACKAGES.items()
]


@pytest.fixture(scope="session", params=NEEDED)
def backend(request: pytest.FixtureRequest) -> Iterator[WorkerBackend]:
    """Yield each back end, with two workers.

    pytest runs the tests of one back end together, as a cluster takes seconds to start.
    """
    backend = make_backend(request.param, 2)
    yield backend
    backend.close()
