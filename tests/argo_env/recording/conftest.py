"""A recorded run on the yard, with a reaction, a pause, rounds and an abnormal value."""

from types import SimpleNamespace

import pytest

from argo_compiler.hfsm import Occurred, Pause, Resume
from argo_compiler.il import EventKind, Group
from argo_env.recording.files import recording_to
from argo_env.recording.reader import read_recording
from argo_env.report.files import to_json
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged_events
from tests.yard import measure, mission, opened, shelter, waypoint

PLAN = mission(
    measure(1),
    waypoint("A", 2.05, 2.05),
    measure(2),
    waypoint("B", 3.05, 2.05),
    measure(3),
    groups=(Group(name="Round", start="A", end="B", max_repeat_count=2),),
    reactions=(shelter(2.05, 1.55),),
)
SPEC = RunSpec(
    mission=PLAN,
    site="yard",
    seed=3,
    values={2: 7.25},
    events=logged_events(
        (22.0, Occurred(EventKind.GAS_LEAK, "by hand")),
        (35.0, Occurred(EventKind.ALL_CLEAR)),
        (50.0, Pause()),
        (55.0, Resume()),
    ),
)


def as_stored(record: RunRecord) -> RunRecord:
    """Return a record as reports and recordings store it: in English, without wordings."""
    return RunRecord.model_validate_json(to_json(record))


@pytest.fixture(scope="session")
def record_run(yard):
    """Return a function that runs the plan, records it to a file and returns the run's record."""

    def run(file, spec=SPEC, source=None):
        with recording_to(file, source) as recorder:
            return simulate(spec, opened(yard), observers=[recorder])

    return run


@pytest.fixture(scope="session")
def recorded(record_run, tmp_path_factory):
    """Return the run's record, the recording as a file and as bytes, and its decoded contents."""
    folder = tmp_path_factory.mktemp("recorded")
    source = folder / "plan.txt"
    source.write_text("the plan as a person wrote it", encoding="utf-8")
    file = folder / "run.mcap"
    record = record_run(file, source=source)
    return SimpleNamespace(
        record=record,
        stored=as_stored(record),
        file=file,
        content=file.read_bytes(),
        decoded=read_recording(file),
    )
