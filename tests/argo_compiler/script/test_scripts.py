"""The two original scripts, the two that the project ships, and the fields of their missions."""

from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Remedy
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.il import Action, Group, Mission, Mode, Order, Stop, Transition
from argo_compiler.script import Resolved, read_script
from tests.whole_scripts import import_whole


def warnings(resolved: Resolved) -> list[Diagnostic]:
    return [d for d in resolved.diagnostics if d.severity is not Severity.NOTE]


def assert_mission_1(mission: Mission, catalog: Catalog, start: int, end: int) -> None:
    assert [(t.name, t.object_id, t.action) for t in mission.tasks] == [
        ("START", None, Action.START),
        ("MEASURE 1", "1", Action.MEASURE),
        ("MEASURE 4", "4", Action.MEASURE),
        ("MEASURE 8", "8", Action.MEASURE),
        ("DOCK", None, Action.WAYPOINT),
    ]
    areas = {area.number: area.dock for area in catalog.areas}
    assert (mission.tasks[0].pose, mission.tasks[-1].pose) == (areas[start], areas[end])
    for task, following in zip(mission.tasks, mission.tasks[1:], strict=False):
        assert task.transitions == (Transition(target=following.name),)
    assert mission.tasks[-1].transitions == ()
    assert all(task.source is not None for task in mission.tasks)
    assert mission.designation == "Mission #1"
    assert mission.site == "umad"
    assert mission.mode is Mode.AUTONOMOUS
    assert mission.max_duration == 1200
    assert mission.order is Order.PRECISE
    assert (mission.start_area, mission.end_area) == (start, end)
    assert mission.groups == ()


def assert_protocol_2(mission: Mission, catalog: Catalog) -> None:
    patrol = [f"WAYPOINT {k}" for k in range(1, 5)]
    assert [t.name for t in mission.tasks] == ["START", *patrol, "MEASURE 2", "MEASURE 14"]
    place = catalog.find_place("front of the site")
    floor = catalog.floor(1)
    assert place is not None
    assert floor is not None
    assert mission.tasks[0].pose == place.pose
    assert tuple(t.pose for t in mission.tasks[1:5]) == floor.patrol
    assert {t.group for t in mission.tasks[1:5]} == {"Patrol floor 1"}
    (group,) = mission.groups
    assert group.source is not None
    assert group == Group(
        name="Patrol floor 1",
        start="WAYPOINT 1",
        end="WAYPOINT 4",
        max_repeat_duration=600,
        stop=Stop.HARD,
        source=group.source,
    )
    assert mission.designation == "Mission Protocol #2"
    assert mission.end_area is None


def test_original_sheet(originals: Path, catalog: Catalog) -> None:
    text = read_script(originals / "mission_1.txt")
    for end in (1, 2):
        resolved = import_whole(text, catalog, start_area=1, end_area=end)
        mission = resolved.mission
        assert_mission_1(mission, catalog, 1, end)
        assert mission.anomaly_specification.startswith("Default normal values")
        assert mission.anomaly_specification.endswith("appendix A)")
        assert mission.real_time_reporting == "As per the rules"
        assert mission.after_mission_report == "As per the rules"
        assert {d.code for d in warnings(resolved)} == {"script.healed", "script.no-effect"}
    task = mission.task("MEASURE 4")
    assert task is not None
    assert task.source is not None
    assert (task.source.line, task.source.column) == (17, 4)


def test_shipped_sheet(missions: Path, catalog: Catalog) -> None:
    text = read_script(missions / "mission_1.txt")
    resolved = import_whole(text, catalog, start_area=2, end_area=1)
    assert_mission_1(resolved.mission, catalog, 2, 1)
    assert {d.code for d in warnings(resolved)} == {"script.healed", "script.no-effect"}
    assert resolved.mission.anomaly_specification == (
        "Any reading outside the normal values that the site's catalogue of checkpoints states"
    )
    assert resolved.mission.real_time_reporting == "Each anomaly as soon as it is found"
    assert resolved.mission.after_mission_report == "All readings, and every anomaly once more"


@pytest.mark.parametrize("folder", ["originals", "missions"])
def test_protocol(folder: str, catalog: Catalog, request: pytest.FixtureRequest) -> None:
    path = request.getfixturevalue(folder) / "protocol_2.txt"
    resolved = import_whole(read_script(path), catalog)
    assert {d.code for d in warnings(resolved)} <= {"script.no-effect"}
    assert_protocol_2(resolved.mission, catalog)


def test_a_choice_left_open_needs_the_options(missions: Path, catalog: Catalog) -> None:
    text = read_script(missions / "mission_1.txt")
    with pytest.raises(DiagnosticError) as caught:
        import_whole(text, catalog, source_name="sheet")
    errors = [d for d in caught.value.diagnostics if d.severity is Severity.ERROR]
    assert [d.code for d in errors] == ["script.area-choice"] * 2
    assert [d.hint for d in errors] == ["choose area 1 or 2"] * 2
    assert [d.remedies for d in errors] == [(Remedy.CHOOSE_START,), (Remedy.CHOOSE_END,)]
    assert [d.span.line for d in errors if d.span] == [10, 13]
    assert "script.healed" in {d.code for d in caught.value.diagnostics}
