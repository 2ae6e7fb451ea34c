"""What a mission's route problem says, and in what words."""

from itertools import pairwise

import numpy as np
import pytest
from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import lower
from argo_compiler.il import (
    Action,
    EventKind,
    Group,
    Mission,
    OnFailure,
    Order,
    Stop,
    Task,
    TimeWindow,
    Transition,
)
from argo_compiler.reorder.mission import late_visits, route_problem
from argo_compiler.reorder.requirements import Requirements, parse_seconds
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.route import Tour, evaluate
from tests.mission_writing import above as greater
from tests.mission_writing import measure as measuring
from tests.mission_writing import wait, way

HERE = Pose(x=0, y=0, z=0)
DOCK = Pose(x=9, y=9, z=0)


def measure(id, *ways, **fields):
    return measuring(f"M{id}", *ways, object_id=str(id), **fields)


def above(object_id, target, value=5.0, **fields):
    return way(target, greater(str(object_id), value, **fields))


def row(*tasks, docked=True, order=Order.ANY, **fields):
    """The tasks one after the other: each goes on to the next by its last transition."""
    if docked:
        tasks = (*tasks, Task(name="DOCK", action=Action.WAYPOINT, pose=DOCK))
    linked = [
        a.model_copy(update={"transitions": (*a.transitions, Transition(target=b.name))})
        if not any(not t.conditions for t in a.transitions)
        else a
        for a, b in pairwise(tasks)
    ]
    return Mission(order=order, tasks=(*linked, tasks[-1]), dock=DOCK, **fields)


def ways(mission, time=None, unit=1.0, **fields):
    """10 units from anywhere to anywhere, 2 of them for a measurement, if nothing else is said."""
    names = tuple(t.name for t in mission.tasks)
    n = len(names)
    time = np.full((n + 1, n), 10.0) if time is None else np.array(time, dtype=float)
    work = np.array([2.0 if name.startswith("M") else 0.0 for name in names])
    return TravelMatrix(names, time, time / 10, work, unit=unit, **fields)


def planned(mission, time=None, **requirements):
    return route_problem(mission, ways(mission, time), Requirements(**requirements))


def kept(found):
    return [p.words for p in found.problem.precedences]


def prizes(found):
    return [(v.mandatory, v.prize) for v in found.problem.visits]


def windows(found):
    return [(v.earliest, v.latest) for v in found.problem.visits]


@pytest.mark.rule("M7")
def test_the_order_says_what_may_move_and_nothing_to_the_machine():
    precise, free = (row(measure(4), measure(8), order=order) for order in Order)
    assert lower(precise) == lower(free)
    moved = Tour((1, 0))
    assert not evaluate(planned(precise).problem, moved).feasible
    assert [t.name for t in apply_route(planned(free), moved).tasks] == ["M8", "M4", "DOCK"]


def test_a_precise_order_is_one_rule():
    found = planned(row(measure(4), measure(8), measure(1), order=Order.PRECISE))
    assert kept(found) == ["precise order 4, 8, 1"]
    assert found.problem.precedences[0].sequence == (0, 1, 2)
    assert kept(planned(row(measure(4), measure(8)), keep_order=True)) == ["the order as written"]
    assert kept(planned(row(measure(4), measure(8)))) == []


def test_what_is_asked_for_is_said_in_the_words_of_the_mission():
    found = planned(row(measure(4), measure(8)), before=[(8, "M4")])
    assert kept(found) == ["checkpoint 8 before 'M4'"]
    assert found.problem.precedences[0].sequence == (1, 0)
    with pytest.raises(ArgoError, match="no checkpoint 9"):
        planned(row(measure(4), measure(8)), before=[(9, 4)])
    with pytest.raises(ArgoError, match="is 'M4' meant"):
        planned(row(measure(4), measure(8)), before=[("M44", 8)])
    with pytest.raises(ArgoError, match="'DOCK' stays where it is"):
        planned(row(measure(4), measure(8)), before=[("DOCK", 8)])


def test_a_sequence_holds_without_its_middle():
    mission = row(measure(4), measure(8), measure(1), measure(3))
    found = planned(mission, before=[(8, 4, 1)], budget=100.0)
    assert kept(found) == ["checkpoint 8 before checkpoint 4 before checkpoint 1"]
    for order, feasible in [((2, 1), False), ((1, 2), True), ((1, 0, 2), True), ((0, 1), False)]:
        assert evaluate(found.problem, Tour(order)).feasible == feasible


def test_a_sequence_with_a_group_holds_without_its_middle():
    group = Group(name="G", start="M1", end="M2", max_repeat_count=2)
    mission = row(measure(4), measure(1), measure(2), measure(3), groups=(group,))
    found = planned(mission, before=[("G", 3, 4)], budget=100.0)
    for order, feasible in [((0, 1, 2), False), ((2, 1, 0), True), ((3, 0), True), ((0, 3), False)]:
        assert evaluate(found.problem, Tour(order)).feasible == feasible
    with pytest.raises(ArgoError, match="'G' and checkpoint 2 have a task in common"):
        planned(mission, before=[("G", 2)])


def test_nothing_comes_before_itself():
    with pytest.raises(ValidationError, match="names something twice"):
        Requirements(before=((4, "4"),))


def test_what_a_condition_asks_for_is_measured_before():
    found = planned(row(measure(4), measure(8), measure(7, above(4, "M3")), measure(3), measure(5)))
    (rule,) = found.problem.precedences
    assert rule.words == "checkpoint 4 is measured before checkpoint 7 decides on it"
    assert rule.sequence == (0, 2)
    assert rule.needed


def test_a_measurement_after_a_decision_stays_after_it():
    again = Task(name="again", action=Action.MEASURE, object_id="4")
    found = planned(row(measure(4), measure(7, above(4, "again")), again, measure(8)))
    assert "checkpoint 7 decides on checkpoint 4 before it is measured again" in kept(found)
    assert "the measurements of checkpoint 4 keep their order" in kept(found)
    assert found.visits.names[0] == "checkpoint 4 ('M4')"


def test_what_may_end_the_mission_parts_it():
    found = planned(row(measure(1), measure(2, above(2, "DOCK")), measure(3), measure(4)))
    assert [p.sequence for p in found.problem.precedences] == [(0, 1), (1, 2), (1, 3)]
    assert kept(found)[0] == (
        "checkpoint 2 may end the mission: what is written before it stays before it"
    )


def test_a_loop_moves_as_one():
    found = planned(row(measure(1), measure(2), measure(3, above(3, "M2")), measure(4)))
    assert found.visits.names == ("checkpoint 1", "checkpoint 2", "checkpoint 4")
    assert found.reasons == (
        "'M2' to 'M3' may be done again by a condition: kept as written, and reckoned once",
    )
    changed = apply_route(found, Tour((2, 1, 0)))
    assert [t.name for t in changed.tasks] == ["M4", "M2", "M3", "M1", "DOCK"]
    assert changed.task("M3").transitions[0].target == "M2"
    assert changed.task("M3").transitions[1].target == "M1"


def test_a_group_is_a_round():
    group = Group(
        name="G", start="M1", end="M2", max_repeat_count=3, max_repeat_duration=7.5, stop=Stop.SOFT
    )
    found = planned(row(measure(1), measure(2), measure(3), groups=(group,)))
    (one,) = found.problem.rounds
    assert (one.name, one.members, one.repeat, one.duration, one.soft) == (
        "group 'G'", (0, 1), 3, 8, True,
    )  # fmt: skip
    changed = apply_route(found, Tour((2, 1, 0)))
    assert [t.name for t in changed.tasks] == ["M3", "M2", "M1", "DOCK"]
    assert (changed.groups[0].start, changed.groups[0].end) == ("M2", "M1")


def test_an_endless_group_is_kept_as_it_is_written():
    group = Group(name="G", start="M1", end="M2")
    found = planned(row(measure(1), measure(2, above(2, "M3")), measure(3), groups=(group,)))
    assert found.problem.rounds == ()
    assert "group 'G' is kept as written" in found.reasons[0]
    changed = apply_route(found, Tour((1, 0)))
    assert [t.name for t in changed.tasks] == ["M3", "M1", "M2", "DOCK"]
    assert changed.task("M2").transitions[0].target == "DOCK"


def test_how_old_a_value_is_depends_on_what_comes_between():
    tasks = measure(4), measure(8), measure(7, above(4, "M9", max_age=60.0)), measure(3), measure(9)
    found = planned(row(*tasks))
    assert found.visits.names == ("checkpoint 4", "checkpoint 9")
    assert "asks how old the value of checkpoint 4 is" in found.reasons[0]


def test_the_time_of_a_group_does_not_begin_before_what_goes_along_is_done():
    patrol = Group(name="PATROL", start="M3", end="M4", max_repeat_duration=60.0)
    first = measure(1, above(1, "M2"), Transition(target="M3"))
    mission = row(first, measure(2), measure(3), measure(4), groups=(patrol,))
    time = np.full((6, 5), 10.0)
    time[0, 1] = 500.0
    found = planned(mission, time)
    assert evaluate(found.problem, found.written).duration >= 500 + 60


def test_times_are_those_of_the_worst_way():
    mission = row(measure(1, above(1, "M2"), Transition(target="M3")), measure(2), measure(3))
    time = np.full((5, 4), 10.0)
    time[0, 1], time[1, 2], time[0, 2] = 30.0, 40.0, 20.0

    def takes(found):
        return found.problem.visits[0].service + found.problem.travel[0, 1]

    # M1 takes 2, and so does M3, which is not part of the way.
    assert takes(planned(mission, time)) == 2 + 68
    likely = [{"task": "M1", "target": "M2", "probability": 0.25}]
    assert takes(planned(mission, time, likelihoods=likely)) == 2 + 31
    with pytest.raises(ArgoError, match="no condition of a task 'M1' leads to 'M3'"):
        planned(mission, time, likelihoods=[{"task": "M1", "target": "M3", "probability": 0.5}])


def test_a_budget_makes_all_optional_that_is_not_mandatory():
    group = Group(name="G", start="M1", end="M2", max_repeat_count=2)
    mission = row(measure(1), measure(2), measure(3), measure(4), groups=(group,), max_duration=90)
    found = planned(mission, budget=60.0, mandatory=[3], optional=[{"what": "G", "priority": 5}])
    assert prizes(found) == [(False, 5), (False, 5), (True, 0), (False, 1)]
    assert found.problem.max_duration == 60
    assert found.problem.words == {"max_duration": "budget 1 min"}
    alone = planned(mission)
    assert all(v.mandatory for v in alone.problem.visits)
    assert alone.problem.words == {"max_duration": "maximum duration 1 min 30 s"}


@pytest.mark.rule("W4", "T11")
def test_what_is_asked_for_of_tasks_is_written_into_the_mission():
    own = TimeWindow(latest=50, missed_target="DOCK")
    mission = row(measure(1), measure(2, window=own, optional=True, priority=4), measure(3))
    found = planned(
        mission,
        windows=[{"what": 2, "earliest": "1 min", "latest": "2 min"}, {"what": 3, "earliest": 5}],
        mandatory=[2],
        optional=[{"what": 1, "priority": 3}],
    )
    # A measurement takes 2 itself: it is begun so much before it has to have ended.
    assert windows(found) == [(0, None), (60, 118), (5, None)]
    assert prizes(found) == [(False, 3), (True, 0), (True, 0)]
    one, two, three, _ = apply_route(found, found.written).tasks
    assert (one.optional, one.priority, one.window) == (True, 3, None)
    assert two.window == TimeWindow(earliest=60, latest=120, missed_target="DOCK")
    assert (two.optional, two.priority) == (False, 4)
    assert three.window == TimeWindow(earliest=5)
    assert found.before == ()


def test_a_mission_says_what_is_optional_and_when():
    soft = TimeWindow(latest=30, hard=False)
    mission = row(
        measure(1, optional=True, priority=7),
        measure(2, window=TimeWindow(earliest=20, latest=40)),
        measure(3, window=soft),
    )
    found = planned(mission)
    assert prizes(found) == [(False, 7), (True, 0), (True, 0)]
    assert windows(found) == [(0, None), (20, 38), (0, None)]
    assert list(late_visits(found, found.written)) == [
        "checkpoint 3 is done at 32 s, after its soft time window: 30 s"
    ]


def test_a_group_is_optional_if_all_of_it_is():
    group = Group(name="G", start="M1", end="M2", max_repeat_count=2)
    for second, mandatory in ((True, [False, False, True]), (False, [True, True, True])):
        mission = row(
            measure(1, optional=True), measure(2, optional=second), measure(3), groups=(group,)
        )
        assert [v.mandatory for v in planned(mission).problem.visits] == mandatory


def test_a_wait_stays_with_the_task_before_it():
    found = planned(row(measure(1), wait("W", duration=7), measure(2)))
    name = found.visits.spine.name
    leaves = [[name(leaf) for leaf in stop.leaves] for stop in found.visits.stops]
    assert leaves == [["M1", "W"], ["M2"]]
    moved = Tour((1, 0))
    assert evaluate(found.problem, moved).duration == 10 + 10 + 7 + 10
    assert [t.name for t in apply_route(found, moved).tasks] == ["M2", "M1", "W", "DOCK"]


def test_a_wait_for_an_event_is_reckoned_with_its_limit():
    found = planned(row(measure(1), wait("W", event=EventKind.ALL_CLEAR, limit=30), measure(2)))
    assert found.reasons == ("'W' is reckoned with all of its limit",)
    assert evaluate(found.problem, found.written).duration == 10 + 30 + 10 + 10


def test_a_wait_before_all_else_stays_there():
    found = planned(row(wait("W", duration=7), measure(1), measure(2)))
    assert set(kept(found)) == {"'W' is done before the robot sets off"}
    assert evaluate(found.problem, Tour((0, 2, 1))).duration == 7 + 10 + 10 + 10


def test_a_failure_branch_is_a_way():
    ahead = measure(1, on_failure=OnFailure.BRANCH, failure_target="M3")
    found = planned(row(ahead, measure(2), measure(3), measure(4)))
    names = [[found.visits.spine.name(leaf) for leaf in s.leaves] for s in found.visits.stops]
    assert names == [["M1", "M2"], ["M3"], ["M4"]]
    tasks = {t.name: t for t in apply_route(found, Tour((0, 2, 1))).tasks}
    assert tasks["M1"].failure_target == "M4"


def test_a_missed_window_is_a_way():
    late = measure(1, window=TimeWindow(latest=60, missed_target="M3"))
    found = planned(row(late, measure(2), measure(3), measure(4)))
    tasks = {t.name: t for t in apply_route(found, Tour((0, 2, 1))).tasks}
    assert tasks["M1"].window == TimeWindow(latest=60, missed_target="M4")


def test_a_time_limit_rules_out_no_way_as_a_further_attempt_goes_on_from_there():
    time = np.full((4, 3), 10.0)
    time[3, 0] = 30.0  # from the start to M1
    found = planned(row(measure(1, time_limit=20), measure(2)), time)
    assert evaluate(found.problem, found.written).duration == 30 + 10 + 10
    assert found.reasons == (
        "'M1' may take longer than its time limit, 20 s, depending on where the robot comes from: "
        "reckoned as if it had none",
    )
    assert found.if_assumed == " if no time limit ends an action"
    assert not planned(row(measure(1, time_limit=30), measure(2)), time).reasons


@pytest.mark.parametrize(
    ("tasks", "groups", "said"),
    [
        ((measure(1), wait("W", event=EventKind.ALL_CLEAR, limit=None)), (), "how long 'W' waits"),
        (
            (measure(1),),
            (Group(name="G", start="M1", end="M1", max_repeat_count=2, every=60),),
            "Argo can't reckon orders of missions with planned rounds yet",
        ),
        (
            (measure(1, window=TimeWindow(latest=60)), measure(2)),
            (Group(name="G", start="M1", end="M2", max_repeat_count=2),),
            "'M1' can't be kept by an order: it lies in a group",
        ),
    ],
)
def test_what_can_not_be_reckoned_is_refused(tasks, groups, said):
    with pytest.raises(ArgoError, match=said):
        planned(row(*tasks, groups=groups))


def test_what_ends_a_round_early_is_measured_before_or_after_as_it_was():
    group = Group(name="G", start="M2", end="M3", max_repeat_count=3, until=above(1, "").conditions)
    found = planned(row(measure(1), measure(2), measure(3), measure(4), groups=(group,)))
    assert "checkpoint 1 is measured before checkpoint 3 decides on it" in kept(found)
    assert "'G' is reckoned with as many rounds as it may have" in found.reasons


def test_a_mission_can_not_charge():
    mission = row(measure(1), measure(2))
    time = np.full((5, 4), 10.0)
    found = route_problem(
        mission,
        TravelMatrix(
            ("M1", "M2", "DOCK"), time, time, np.array([2.0, 2.0, 0.0, 0.0]),
            ("docking station 1",), battery=25.0, charging=3600.0, unit=1.0,
        ),
    )  # fmt: skip
    assert found.problem.battery.capacity == 25
    assert not evaluate(found.problem, found.written).feasible
    with pytest.raises(ArgoError, match="charges at docking station 1 when the robot has done"):
        apply_route(found, Tour((0, 1), {1: 0}))


def test_a_mission_that_does_not_dock_ends_with_one_task():
    mission = row(measure(1, above(1, "M2"), Transition(target="M3")), measure(2), measure(3),
                  docked=False)  # fmt: skip
    found = planned(mission, budget=60.0)
    assert kept(found) == ["the mission can't end with checkpoint 1, which goes on in several ways"]
    assert [v.mandatory for v in found.problem.visits] == [False, True]
    assert found.problem.travel[1, 2] == 0


@pytest.mark.rule("T6")
def test_a_task_is_come_to_at_its_own_speed_in_any_order():
    found = planned(row(measure(1, velocity=0.2), measure(2)))
    speeds = {t.name: t.velocity for t in apply_route(found, Tour((1, 0))).tasks}
    assert speeds == {"M2": None, "M1": 0.2, "DOCK": None}


def test_what_no_way_leads_to_has_no_place():
    with pytest.raises(ArgoError, match="no way leads to task 'M2'"):
        planned(row(measure(1, Transition(target="DOCK")), measure(2)))


def test_a_mission_without_tasks_is_not_written():
    found = planned(row(measure(1), measure(2), docked=False), budget=1.0)
    with pytest.raises(ArgoError, match="leaves out every task"):
        apply_route(found, Tour(()))
    docked = planned(row(measure(1), measure(2)), budget=1.0)
    assert [t.name for t in apply_route(docked, Tour(())).tasks] == ["DOCK"]


def test_an_order_that_breaks_a_rule_is_not_written():
    found = planned(row(measure(1), measure(2)), before=[(1, 2)])
    with pytest.raises(ArgoError, match="checkpoint 1 before checkpoint 2"):
        apply_route(found, Tour((1, 0)))


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("20 min", 1200), ("20min", 1200), ("1 h 30 min", 5400), ("90", 90), ("1.5 h", 5400),
     ("20'", 1200), ("2 minutes 5 s", 125), ("1h", 3600)],
)  # fmt: skip
def test_durations_are_read(text, seconds):
    assert parse_seconds(text) == seconds


@pytest.mark.parametrize(
    "text", ["", "soon", "-5 min", "5 miles", "5 s 2 min", "-3 min", "3 min 4 min"]
)
def test_what_is_no_duration_is_refused(text):
    with pytest.raises(ArgoError, match="20 min"):
        parse_seconds(text)


@pytest.mark.rule("M10")
def test_what_comes_before_what_is_kept_and_written():
    mission = row(measure(1), measure(2), measure(3), before=(("M3", "M1"), ("M2", "DOCK")))
    found = route_problem(mission, ways(mission))
    assert [(p.sequence, p.words) for p in found.problem.precedences] == [
        ((2, 0), "checkpoint 3 before checkpoint 1")
    ]
    asked = Requirements(before=((2, 3, 1),))
    found = route_problem(mission, ways(mission), asked)
    written = apply_route(found, Tour((1, 2, 0)))
    assert written.before == (*mission.before, ("M2", "M3"))
    with pytest.raises(ArgoError, match="checkpoint 3 before checkpoint 1"):
        apply_route(route_problem(mission, ways(mission)), Tour((0, 1, 2)))
