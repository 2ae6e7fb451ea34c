"""Diagnostics of the analysis on ends, loops, limits and unreachable locations."""

import pytest

from argo_compiler.analysis import analyse
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import CODES, Severity
from argo_compiler.il import (
    Action,
    EventKind,
    Group,
    Reaction,
    Response,
    Stop,
    Task,
    TimeWindow,
)
from tests.argo_compiler.analysis.building import (
    CATALOG,
    DOCK,
    ConstantTravel,
    mission,
    task,
    transition,
)
from tests.mission_writing import drive, wait

FAR = Pose(x=-1, y=0, z=0)


def findings(made, travel=None):
    found = analyse(made, CATALOG, travel).diagnostics
    for d in found:
        assert CODES[d.code].severity is d.severity or d.code in SOFTENED
        assert d.hint
        assert d.span is not None or d.subject is not None
    return {d.code.removeprefix("analysis."): d for d in found}


SOFTENED = {"analysis.endless-loop", "analysis.no-end"}
"""codes of errors that are warnings if a reaction may end the mission"""


def test_a_mission_that_ends_has_no_findings():
    assert findings(mission("A", "Bm1", "C"), ConstantTravel()) == {}


def test_a_loop_that_nothing_leaves():
    found = findings(mission("A", task("B", "C"), task("C", "B")))
    assert set(found) == {"endless-loop"}
    assert "tasks 'B' and 'C' follow each other for ever" in found["endless-loop"].message
    assert "ends the loop, and so the mission (path: A > B)" in found["endless-loop"].message
    assert found["endless-loop"].severity is Severity.ERROR


def test_an_endless_loop_beside_the_path_to_the_end():
    found = findings(mission(task("Am1", transition("B", "1 < 5"), "End"), task("B", "B"), "End"))
    assert set(found) == {"endless-loop"}
    assert found["endless-loop"].subject == "tasks['B']"


def test_a_reaction_that_ends_the_mission_makes_it_a_warning():
    reaction = Reaction(event=EventKind.LOW_BATTERY, response=Response.ABORT)
    found = findings(mission("A", task("B", "B"), reactions=(reaction,)))
    assert {d.severity for d in found.values()} == {Severity.WARNING}


def test_a_loop_that_may_go_on():
    loop = [task("Am1", transition("Am1", "1 < 5"), "B"), "B"]
    assert set(findings(mission(*loop))) == {"unbounded-loop"}
    limited = Group(name="G", start="Am1", end="B", max_repeat_duration=60)
    assert findings(mission(*loop, groups=(limited,))) == {}
    leave = task("Am1", transition("End", "1 < 5"), "B")
    endless = mission(leave, "B", "End", groups=(Group(name="G", start="Am1", end="B"),))
    assert "group 'G' may be repeated without limit" in findings(endless)["unbounded-loop"].message


def test_what_follows_a_round_whose_time_is_up_is_looked_at_without_travel_times():
    loop = [task("Bm1", transition("Bm1", "1 < 5"), "End"), "End"]
    timed = Group(name="G", start="A", end="A", max_repeat_duration=60, stop=Stop.HARD)
    assert set(findings(mission("A", *loop, groups=(timed,)))) == {"unbounded-loop"}


def test_where_the_mission_ends():
    home = drive("Home", pose=DOCK)
    early = task("Am1", transition("B", "1 < 5"), "Home")
    found = findings(mission(early, home, "B", end_area=1))
    assert set(found) == {"end-elsewhere"}
    assert "path: Am1 > B" in found["end-elsewhere"].message
    assert findings(mission("A", home, end_area=1)) == {}
    hard = Group(name="G", start="A", end="Home", max_repeat_duration=5, stop=Stop.HARD)
    found = findings(mission("A", home, groups=(hard,), end_area=1))
    assert "the time of group 'G' is up" in found["end-elsewhere"].message


def test_after_a_wait_the_robot_is_where_it_was():
    home, join = drive("Home", "J", pose=DOCK), wait("J", duration=0)
    assert findings(mission(task("A", "Home"), home, join, end_area=1)) == {}
    away = mission(task("Am1", transition("J", "1 < 5"), "Home"), home, join, end_area=1)
    assert "after task 'J'" in findings(away)["end-elsewhere"].message
    late = home.model_copy(update={"window": TimeWindow(latest=5)})
    found = findings(mission(task("A", "Home"), late, join, end_area=1))
    assert "after task 'J'" in found["end-elsewhere"].message


@pytest.mark.parametrize(
    ("limit", "expected"),
    [(32, None), (31, "maybe-too-long"), (22, "maybe-too-long"), (21, "too-long")],
)
def test_the_maximum_duration(limit, expected):
    made = mission(
        task("Am1", transition("C", "1 < 5"), "B"), task("B", "C"), "C", max_duration=limit
    )
    found = findings(made, ConstantTravel())
    assert set(found) == ({expected} if expected else set())
    if expected == "too-long":
        assert "at least 22 s" in found[expected].message
        assert "Am1 (12 s) > C (22 s)" in found[expected].message


@pytest.mark.parametrize(
    ("battery", "expected"),
    [(3.0, None), (2.5, "battery-maybe-exceeded"), (1.5, "battery-exceeded")],
)
def test_the_battery(battery, expected):
    travel = ConstantTravel(battery=battery)
    made = mission(task("Am1", transition("C", "1 < 5"), "B"), task("B", "C"), "C")
    assert set(findings(made, travel)) == ({expected} if expected else set())


def test_a_value_that_is_always_too_old():
    made = ["Am1", "B", task("C", transition("Last", "1 < 5", max_age=19), "End"), "End", "Last"]
    found = findings(mission(*made), ConstantTravel())
    assert set(found) == {"always-stale"}
    assert "at least 20 s" in found["always-stale"].message
    made[2] = task("C", transition("Last", "1 < 5", max_age=20), "End")
    assert findings(mission(*made), ConstantTravel()) == {}


def test_locations_that_cannot_be_reached():
    found = findings(mission("A", "Bm1", "C"), ConstantTravel(blocked={"1"}))
    assert set(found) == {"unreachable-place"}
    assert "a wall stands in the way" in found["unreachable-place"].message
    shelter = Reaction(event=EventKind.GAS_LEAK, response=Response.SAFE_AREA, pose=FAR)
    found = findings(mission("A", reactions=(shelter,)), ConstantTravel())
    assert found["unreachable-place"].subject == "reactions['gas_leak'].pose"
    back = Reaction(event=EventKind.LOW_BATTERY, response=Response.RETURN)
    found = findings(mission("A", dock=FAR, reactions=(back,)), ConstantTravel())
    assert found["unreachable-place"].subject == "dock"
    other = Reaction(event=EventKind.LOW_BATTERY, response=Response.RETURN, pose=FAR)
    found = findings(mission("A", dock=DOCK, reactions=(other,)), ConstantTravel())
    assert found["unreachable-place"].subject == "reactions['low_battery'].pose"
    near = other.model_copy(update={"pose": DOCK})
    assert findings(mission("A", dock=FAR, reactions=(near,)), ConstantTravel()) == {}


def test_groups_nested_a_thousand_deep():
    names = ["/".join(map(str, range(k + 1))) for k in range(1000)]
    groups = [Group(name=n, start="A", end="C", max_repeat_count=2) for n in names]
    found = analyse(mission("A", "B", "C", groups=groups), CATALOG, ConstantTravel())
    assert found.reachable == {"A", "B", "C"}


def test_a_mission_of_a_start_alone():
    start = Task(name="S", action=Action.START)
    found = analyse(mission(start), CATALOG, ConstantTravel())
    assert found.diagnostics == ()
    assert found.duration is not None
    assert found.duration.most.value == 0


HOME = Reaction(event=EventKind.TIME_UP, response=Response.RETURN)


def test_a_mission_that_its_maximum_duration_cuts_short():
    patrol = Group(name="G", start="B", end="C", max_repeat_duration=600, stop=Stop.HARD)
    plan = {"groups": (patrol,), "max_duration": 120, "dock": DOCK}
    found = findings(mission("A", "B", "C", "D", reactions=(HOME,), **plan), ConstantTravel())
    assert set(found) == {"cut-short"}
    # 2 min, cleaning up, the rest of a drive and the drive home.
    assert "then ends it, after 2 min 21 s at most" in found["cut-short"].message
    assert "'D' will not be done in time" in found["cut-short"].message
    assert "'B' and 'C' may not be done, or not in all rounds" in found["cut-short"].message
    # Nothing ends it without the reaction.
    assert set(findings(mission("A", "B", "C", "D", **plan), ConstantTravel())) == {"too-long"}
    enough = mission("A", "B", max_duration=20, dock=DOCK, reactions=(HOME,))
    assert findings(enough, ConstantTravel()) == {}


@pytest.mark.parametrize(
    ("latest", "hard", "expected"),
    [
        (19, True, "window-missed"),
        (19, False, "window-late"),
        (21, True, None),
        (20, False, None),
    ],
)
def test_windows_that_every_path_misses(latest, hard, expected):
    late = task("B", "C", window=TimeWindow(latest=latest, hard=hard))
    found = findings(mission("A", late, "C"), ConstantTravel())
    assert set(found) == ({expected} if expected else set())
    if expected:
        assert "no execution path is in time for task 'B'" in found[expected].message


def test_a_window_that_some_path_misses():
    late = task("C", "D", window=TimeWindow(latest=25))
    found = findings(
        mission(task("Am1", transition("C", "1 < 5"), "B"), "B", late, "D"), ConstantTravel()
    )
    assert set(found) == {"window-maybe-missed"}
    rounds = Group(name="G", start="A", end="B", max_repeat_count=2)
    soft = task("B", "C", window=TimeWindow(latest=25, hard=False))
    found = findings(mission("A", soft, "C", groups=(rounds,)), ConstantTravel())
    assert set(found) == {"window-maybe-missed"}


def test_a_time_limit_that_is_too_short_promises_nothing():
    made = mission("A", task("B", "C", time_limit=9), "C", max_duration=25)
    found = analyse(made, CATALOG, ConstantTravel())
    assert {d.code for d in found.diagnostics} == {"analysis.time-limit"}
    assert found.duration is None


@pytest.mark.rule("T7")
def test_with_retries_a_time_limit_that_is_too_short_for_one_attempt_says_nothing():
    """Each attempt continues from where the last one stopped, so several may suffice."""
    made = mission("A", task("B", "C", time_limit=9, retries=1), "C", max_duration=25)
    found = analyse(made, CATALOG, ConstantTravel())
    assert found.diagnostics == ()
    assert found.duration is None


@pytest.mark.rule("T9")
def test_the_time_before_a_window_opens_does_not_count_for_the_limit():
    late = TimeWindow(earliest=100)
    limited = task("B", "C", time_limit=9, window=late)
    assert analyse(mission("A", limited, "C"), CATALOG, ConstantTravel()).diagnostics == ()
    limited = task("B", "C", time_limit=9)
    assert "time-limit" in findings(mission("A", limited, "C"), ConstantTravel())


def test_the_way_back_with_a_reserve():
    travel = ConstantTravel(battery=5.0)
    # Each drive takes 1 Wh, also the way back, and 1 Wh must remain.
    made = mission("A", "B", "C", "D", dock=DOCK)
    found = findings(made, travel)
    assert set(found) == {"no-way-back"}
    assert found["no-way-back"].subject == "tasks['D']"
    assert "with a reserve of 20%" in found["no-way-back"].message
    assert findings(mission("A", "B", "C", dock=DOCK), travel) == {}


def test_a_robot_that_may_charge_meanwhile_may_go_farther():
    travel = ConstantTravel(battery=1.5)
    stays = wait("W", "B", duration=3600)
    assert set(findings(mission(task("A", "W"), stays, "B"), travel)) == {"battery-maybe-exceeded"}
