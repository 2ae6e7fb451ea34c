"""One call from a mission to its record: what may be asked for, and what is refused."""

import pytest

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Task
from argo_env.run.drives_and_sensors import DRIVES
from argo_env.run.rig import true_values
from tests.yard import Watching, from_place, simulated


@pytest.fixture(scope="module")
def short():
    here, there = Pose(x=8.05, y=-2.05, z=-0.03), Pose(x=8.55, y=-2.05, z=-0.03)
    return from_place(here, Task(name="A", action=Action.WAYPOINT, pose=there))


def test_record_says_what_it_was_made_with(short, navigator):
    record = simulated(short, navigator, seed=11)
    assert (record.site, record.robot) == ("umad", "tracker")
    assert (record.drive, record.sensor) == ("kinematic", "ideal")
    assert record.seed == 11
    assert record.mission == short


def test_unknown_drive(short, navigator):
    with pytest.raises(ArgoError, match="no drive `rocket`; there are: route, kinematic, tracked"):
        simulated(short, navigator, drive="rocket")
    assert set(DRIVES) >= {"kinematic"}


def test_unknown_sensor(short, navigator):
    with pytest.raises(ArgoError, match="no sensor `nose`; there are: ideal"):
        simulated(short, navigator, sensor="nose")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({99: 1.0}, "umad has no checkpoint 99"),
        ({1: 10.1}, r"checkpoint 1 \(pressure gauge 1\) shows 0 to 10 bar, not 10.1"),
        ({4: -0.1}, "shows 0 to 90 deg, not -0.1"),
    ],
)
def test_values_that_make_no_sense(short, navigator, values, message):
    with pytest.raises(ArgoError, match=message):
        simulated(short, navigator, values=values)


def test_given_values_replace_drawn_ones(umad):
    drawn, given = true_values(umad, 5, {}), true_values(umad, 5, {1: 0.0, 2: 100.0})
    assert given == drawn | {1: 0.0, 2: 100.0}


def test_window_without_a_display(short, navigator, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(ArgoError, match="DISPLAY"):
        simulated(short, navigator, gui=True)


@pytest.mark.parametrize("pace", [0.0, -1.0, float("nan")])
def test_a_pace_that_makes_no_sense(short, navigator, pace):
    with pytest.raises(Invalid, match="more than 0"):
        simulated(short, navigator, pace=pace)


def test_pace_changes_nothing_but_the_time_it_takes(short, navigator):
    seen = []
    paced = simulated(
        short,
        navigator,
        pace=1000.0,
        observers=[Watching(lambda now, task: seen.append((now, task)))],
    )
    assert paced == simulated(short, navigator)
    assert seen[-1] == (paced.result.duration, None)
