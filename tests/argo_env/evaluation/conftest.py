"""What the tests of evaluations share: a short mission, and plans of it."""

from collections.abc import Iterator
from importlib.util import find_spec

import pytest

from argo_compiler.il import Action, Mission, Task
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import make_backend
from argo_env.planning.opening import open_site
from argo_env.run.spec import RunSpec
from tests.yard import from_place


def short_mission(limit: float | None = None) -> Mission:
    """One gauge of UMAD, from its first dock."""
    start = open_site("umad").site.docks[1]
    gauge = Task(name="GAUGE", action=Action.MEASURE, object_id="1")
    return from_place(start, gauge, max_duration=limit)


@pytest.fixture(scope="session")
def mission() -> Mission:
    return short_mission()


@pytest.fixture(scope="session")
def plan(mission) -> EvaluationPlan:
    """The short mission in ten worlds, by travel times."""
    case = EvaluationCase(mission="short", spec=RunSpec(mission=mission, drive="route"))
    return EvaluationPlan(cases=(case,), seeds=tuple(range(10)))


PACKAGES = {"processes": "loky", "ray": "ray", "dask": "distributed"}
NEEDED = [
    pytest.param(
        name,
        marks=pytest.mark.skipif(
            find_spec(package) is None, reason=f"needs `{package}`: pip install '.[cluster]'"
        ),
    )
    for name, package in PACKAGES.items()
]


@pytest.fixture(scope="session", params=NEEDED)
def backend(request: pytest.FixtureRequest) -> Iterator[WorkerBackend]:
    """Each back end once, with two workers: pytest puts the tests of one together, as a cluster
    takes seconds to start."""
    made = make_backend(request.param, 2)
    yield made
    made.close()
