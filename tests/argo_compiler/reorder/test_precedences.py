"""Route problems of missions: precedences, windows and times, and the messages about them."""

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
from argo_compiler.reorder.mission_problem import late_visit_texts, route_problem
from argo_compiler.reorder.requirements import Requirements, parse_seconds
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.route import Tour, evaluate
from tests.mission_writing import above as greater
from tests.mission_writing import measure as measuring
from tests.mission_writing import wait, way

HERE = Pose(x=0, y=0, z=0)
DOCK = Pose(x=9, y=9, z=0)


def measure(id, *transitions, **fields):
    return measuring(f"M{id}", *transitions, object_id=str(id), **fields)


def above(object_id, target, value=5.0, **fields):
    return way(target, greater(str(object_id), value, **fields))


def sequence(*tasks, docked=True, order=Order.ANY, **fields):
    """Return a mission of these tasks in sequence: each leads to the next one."""
    if docked:
        tasks = (*tasks, Task(name="DOCK", action=Action.WAYPOINT, pose=DOCK))
    linked = [
        a.model_copy(update={"transitions": (*a.transitions, Transition(target=b.name))})
        if not any(not t.conditions for t in a.transitions)
        else a
        for a, b in pairwise(tasks)
    ]
    return Mission(order=order, tasks=(*linked, tasks[-1]), dock=DOCK, **fields)


def matrix(mission, time=None, unit=1.0, **fields):
    """Return a matrix; without `time` each drive takes 10 units, 2 of them for a measurement."""
    names = tuple(t.name for t in mission.tasks)
    n = len(names)
    time = np.full((n + 1, n), 10.0) if time is None else np.array(time, dtype=float)
    work = np.array([2.0 if name.startswith("M") else 0.0 for name in names])
    return TravelMatrix(names, time, time / 10, work, unit=unit, **fields)


def make_problem(mission, time=None, **requirements):
    return route_problem(mission, matrix(mission, time), Requirements(**requirements))


def kept_orders(planned):
    return [p.words for p in planned.problem.precedences]


def prizes(planned):
    return [(v.mandatory, v.prize) for v in planned.problem.visits]


def windows(planned):
    return [(v.earliest, v.latest) for v in planned.problem.visits]


@pytest.mark.rule("M7")
def test_the_order_changes_what_may_move_but_not_the_machine():
    precise, free = (sequence(measure(4), measure(8), order=order) for order in Order)
    assert lower(precise) == lower(free)
    moved = Tour((1, 0))
    assert not evaluate(make_problem(precise).problem, moved).feasible
    assert [t.name for t in apply_route(make_problem(free), moved).tasks] == ["M8", "M4", "DOCK"]


def test_a_precise_order_is_one_rule():
    planned = make_problem(sequence(measure(4), measure(8), measure(1), order=Order.PRECISE))
    assert kept_orders(planned) == ["precise order 4, 8, 1"]
    assert planned.problem.precedences[0].sequence == (0, 1, 2)
    assert kept_orders(make_problem(sequence(measure(4), measure(8)), keep_order=True)) == [
        "the order as written"
    ]
    assert kept_orders(make_problem(sequence(measure(4), measure(8)))) == []


def test_requirements_are_described_in_the_words_of_the_mission():
    planned = make_problem(sequence(measure(4), measure(8)), before=[(8, "M4")])
    assert kept_orders(planned) == ["checkpoint 8 before 'M4'"]
    assert planned.problem.precedences[0].sequence == (1, 0)
    with pytest.raises(ArgoError, match="no checkpoint 9"):
        make_problem(sequence(measure(4), measure(8)), before=[(9, 4)])
    with pytest.raises(ArgoError, match="is 'M4' meant"):
        make_problem(sequence(measure(4), measure(8)), before=[("M44", 8)])
    with pytest.raises(
        ArgoError, match="'DOCK' ends the mission, so its place in the order is fixed"
    ):
        make_problem(sequence(measure(4), measure(8)), before=[("DOCK", 8)])


def test_a_sequence_is_kept_without_its_middle():
    mission = sequence(measure(4), measure(8), measure(1), measure(3))
    planned = make_problem(mission, before=[(8, 4, 1)], budget=100.0)
    assert kept_orders(planned) == ["checkpoint 8 before checkpoint 4 before checkpoint 1"]
    for order, feasible in [((2, 1), False), ((1, 2), True), ((1, 0, 2), True), ((0, 1), False)]:
        assert evaluate(planned.problem, Tour(order)).feasible == feasible


def test_a_sequence_with_a_group_is_kept_without_its_middle():
    group = Group(name="G", start="M1", end="M2", max_repeat_count=2)
    mission = sequence(measure(4), measure(1), measure(2), measure(3), groups=(group,))
    planned = make_problem(mission, before=[("G", 3, 4)], budget=100.0)
    for order, feasible in [((0, 1, 2), False), ((2, 1, 0), True), ((3, 0), True), ((0, 3), False)]:
        assert evaluate(planned.problem, Tour(order)).feasible == feasible
    with pytest.raises(ArgoError, match="'G' and checkpoint 2 have a task in common"):
        make_problem(mission, before=[("G", 2)])


def test_nothing_comes_before_itself():
    with pytest.raises(ValidationError, match="names something twice"):
        Requirements(before=((4, "4"),))


def test_a_checkpoint_is_measured_before_a_condition_compares_it():
    planned = make_problem(
        sequence(measure(4), measure(8), measure(7, above(4, "M3")), measure(3), measure(5))
    )
    (rule,) = planned.problem.precedences
    assert rule.words == "checkpoint 4 is measured before checkpoint 7 decides on it"
    assert rule.sequence == (0, 2)
    assert rule.needed


def test_a_measurement_after_a_decision_stays_after_it():
    again = Task(name="again", action=Action.MEASURE, object_id="4")
    planned = make_problem(sequence(measure(4), measure(7, above(4, "again")), again, measure(8)))
    assert "checkpoint 7 decides on checkpoint 4 before it is measured again" in kept_orders(
        planned
    )
    assert "the measurements of checkpoint 4 keep their order" in kept_orders(planned)
    assert planned.visits.names[0] == "checkpoint 4 ('M4')"


def test_a_task_that_may_end_the_mission_separates_the_others():
    planned = make_problem(
        sequence(measure(1), measure(2, above(2, "DOCK")), measure(3), measure(4))
    )
    assert [p.sequence for p in planned.problem.precedences] == [(0, 1), (1, 2), (1, 3)]
    assert kept_orders(planned)[0] == (
        "checkpoint 2 may end the mission: what is written before it stays before it"
    )


def test_a_loop_moves_as_one():
    planned = make_problem(sequence(measure(1), measure(2), measure(3, above(3, "M2")), measure(4)))
    assert planned.visits.names == ("checkpoint 1", "checkpoint 2", "checkpoint 4")
    assert planned.reasons == (
        "'M2' to 'M3' may be done again by a condition: kept as written, and counted once",
    )
    changed = apply_route(planned, Tour((2, 1, 0)))
    assert [t.name for t in changed.tasks] == ["M4", "M2", "M3", "M1", "DOCK"]
    assert changed.task("M3").transitions[0].target == "M2"
    assert changed.task("M3").transitions[1].target == "M1"


def test_a_group_is_a_round():
    group = Group(
        name="G", start="M1", end="M2", max_repeat_count=3, max_repeat_duration=7.5, stop=Stop.SOFT
    )
    planned = make_problem(sequence(measure(1), measure(2), measure(3), groups=(group,)))
    (first,) = planned.problem.rounds
    assert (first.name, first.members, first.repeat, first.duration, first.soft) == (
        "group 'G'", (0, 1), 3, 8, True,
    )  # fmt: skip
    changed = apply_route(planned, Tour((2, 1, 0)))
    assert [t.name for t in changed.tasks] == ["M3", "M2", "M1", "DOCK"]
    assert (changed.groups[0].start, changed.groups[0].end) == ("M2", "M1")


def test_an_endless_group_is_kept_as_it_is_written():
    group = Group(name="G", start="M1", end="M2")
    planned = make_problem(
        sequence(measure(1), measure(2, above(2, "M3")), measure(3), groups=(group,))
    )
    assert planned.problem.rounds == ()
    assert "group 'G' is kept as written" in planned.reasons[0]
    changed = apply_route(planned, Tour((1, 0)))
    assert [t.name for t in changed.tasks] == ["M3", "M1", "M2", "DOCK"]
    assert changed.task("M2").transitions[0].target == "DOCK"


def test_a_condition_on_the_age_of_a_value_keeps_the_tasks_before_it():
    tasks = measure(4), measure(8), measure(7, above(4, "M9", max_age=60.0)), measure(3), measure(9)
    planned = make_problem(sequence(*tasks))
    assert planned.visits.names == ("checkpoint 4", "checkpoint 9")
    assert "checks the age of the value of checkpoint 4" in planned.reasons[0]


def test_the_time_of_a_group_starts_after_the_conditional_tasks_before_it():
    patrol = Group(name="PATROL", start="M3", end="M4", max_repeat_duration=60.0)
    first = measure(1, above(1, "M2"), Transition(target="M3"))
    mission = sequence(first, measure(2), measure(3), measure(4), groups=(patrol,))
    time = np.full((6, 5), 10.0)
    time[0, 1] = 500.0
    planned = make_problem(mission, time)
    assert evaluate(planned.problem, planned.written).duration >= 500 + 60


def test_times_are_those_of_the_worst_case():
    mission = sequence(measure(1, above(1, "M2"), Transition(target="M3")), measure(2), measure(3))
    time = np.full((5, 4), 10.0)
    time[0, 1], time[1, 2], time[0, 2] = 30.0, 40.0, 20.0

    def takes(planned):
        return planned.problem.visits[0].service + planned.problem.travel[0, 1]

    # M1 takes 2, and so does M3, which is not part of the travel time.
    assert takes(make_problem(mission, time)) == 2 + 68
    likely = [{"task": "M1", "target": "M2", "probability": 0.25}]
    assert takes(make_problem(mission, time, likelihoods=likely)) == 2 + 31
    with pytest.raises(ArgoError, match="no condition of a task 'M1' leads to 'M3'"):
        make_problem(
            mission, time, likelihoods=[{"task": "M1", "target": "M3", "probability": 0.5}]
        )


def test_a_budget_makes_all_optional_that_is_not_mandatory():
    group = Group(name="G", start="M1", end="M2", max_repeat_count=2)
    mission = sequence(
        measure(1), measure(2), measure(3), measure(4), groups=(group,), max_duration=90
    )
    planned = make_problem(
        mission, budget=60.0, mandatory=[3], optional=[{"what": "G", "priority": 5}]
    )
    assert prizes(planned) == [(False, 5), (False, 5), (True, 0), (False, 1)]
    assert planned.problem.max_duration == 60
    assert planned.problem.words == {"max_duration": "budget 1 min"}
    alone = make_problem(mission)
    assert all(v.mandatory for v in alone.problem.visits)
    assert alone.problem.words == {"max_duration": "maximum duration 1 min 30 s"}


@pytest.mark.rule("W4", "T11")
def test_requirements_of_tasks_are_written_into_the_mission():
    own = TimeWindow(latest=50, missed_target="DOCK")
    mission = sequence(measure(1), measure(2, window=own, optional=True, priority=4), measure(3))
    planned = make_problem(
        mission,
        windows=[{"what": 2, "earliest": "1 min", "latest": "2 min"}, {"what": 3, "earliest": 5}],
        mandatory=[2],
        optional=[{"what": 1, "priority": 3}],
    )
    # A measurement takes 2 itself: its latest start is 2 before its latest end.
    assert windows(planned) == [(0, None), (60, 118), (5, None)]
    assert prizes(planned) == [(False, 3), (True, 0), (True, 0)]
    first, second, third, _ = apply_route(planned, planned.written).tasks
    assert (first.optional, first.priority, first.window) == (True, 3, None)
    assert second.window == TimeWindow(earliest=60, latest=120, missed_target="DOCK")
    assert (second.optional, second.priority) == (False, 4)
    assert third.window == TimeWindow(earliest=5)
    assert planned.before == ()


def test_a_mission_states_optional_tasks_and_windows():
    soft = TimeWindow(latest=30, hard=False)
    mission = sequence(
        measure(1, optional=True, priority=7),
        measure(2, window=TimeWindow(earliest=20, latest=40)),
        measure(3, window=soft),
    )
    planned = make_problem(mission)
    assert prizes(planned) == [(False, 7), (True, 0), (True, 0)]
    assert windows(planned) == [(0, None), (20, 38), (0, None)]
    assert list(late_visit_texts(planned, planned.written)) == [
        "checkpoint 3 is done at 32 s, after its soft time window: 30 s"
    ]


def test_a_group_is_optional_if_all_of_it_is():
    group = Group(name="G", start="M1", end="M2", max_repeat_count=2)
    for second, mandatory in ((True, [False, False, True]), (False, [True, True, True])):
        mission = sequence(
            measure(1, optional=True), measure(2, optional=second), measure(3), groups=(group,)
        )
        assert [v.mandatory for v in make_problem(mission).problem.visits] == mandatory


def test_a_wait_stays_with_the_task_before_it():
    planned = make_problem(sequence(measure(1), wait("W", duration=7), measure(2)))
    name = planned.visits.chain.name
    leaves = [[name(leaf) for leaf in stop.leaves] for stop in planned.visits.task_units]
    assert leaves == [["M1", "W"], ["M2"]]
    moved = Tour((1, 0))
    assert evaluate(planned.problem, moved).duration == 10 + 10 + 7 + 10
    assert [t.name for t in apply_route(planned, moved).tasks] == ["M2", "M1", "W", "DOCK"]


def test_a_wait_for_an_event_counts_with_its_limit():
    planned = make_problem(
        sequence(measure(1), wait("W", event=EventKind.ALL_CLEAR, limit=30), measure(2))
    )
    assert planned.reasons == ("'W' is assumed to take its whole limit",)
    assert evaluate(planned.problem, planned.written).duration == 10 + 30 + 10 + 10


def test_an_initial_wait_stays_first():
    planned = make_problem(sequence(wait("W", duration=7), measure(1), measure(2)))
    assert set(kept_orders(planned)) == {"'W' is done before the robot sets off"}
    assert evaluate(planned.problem, Tour((0, 2, 1))).duration == 7 + 10 + 10 + 10


def test_a_failure_branch_counts_as_a_transition():
    ahead = measure(1, on_failure=OnFailure.BRANCH, failure_target="M3")
    planned = make_problem(sequence(ahead, measure(2), measure(3), measure(4)))
    names = [
        [planned.visits.chain.name(leaf) for leaf in s.leaves] for s in planned.visits.task_units
    ]
    assert names == [["M1", "M2"], ["M3"], ["M4"]]
    tasks = {t.name: t for t in apply_route(planned, Tour((0, 2, 1))).tasks}
    assert tasks["M1"].failure_target == "M4"


def test_a_missed_window_counts_as_a_transition():
    late = measure(1, window=TimeWindow(latest=60, missed_target="M3"))
    planned = make_problem(sequence(late, measure(2), measure(3), measure(4)))
    tasks = {t.name: t for t in apply_route(planned, Tour((0, 2, 1))).tasks}
    assert tasks["M1"].window == TimeWindow(latest=60, missed_target="M4")


def test_a_time_limit_rules_out_no_drive_because_a_retry_continues_it():
    time = np.full((4, 3), 10.0)
    time[3, 0] = 30.0  # from the start to M1
    planned = make_problem(sequence(measure(1, time_limit=20), measure(2)), time)
    assert evaluate(planned.problem, planned.written).duration == 30 + 10 + 10
    assert planned.reasons == (
        "'M1' may take longer than its time limit, 20 s, depending on where the robot comes from: "
        "computed as if it had none",
    )
    assert planned.assumptions_clause == " if no time limit ends an action"
    assert not make_problem(sequence(measure(1, time_limit=30), measure(2)), time).reasons


@pytest.mark.parametrize(
    ("tasks", "groups", "message"),
    [
        ((measure(1), wait("W", event=EventKind.ALL_CLEAR, limit=None)), (), "how long 'W' waits"),
        (
            (measure(1),),
            (Group(name="G", start="M1", end="M1", max_repeat_count=2, every=60),),
            "Argo can't compute orders of missions with planned rounds yet",
        ),
        (
            (measure(1, window=TimeWindow(latest=60)), measure(2)),
            (Group(name="G", start="M1", end="M2", max_repeat_count=2),),
            "'M1' can't be kept by an order: it is in a group",
        ),
    ],
)
def test_what_can_not_be_computed_is_refused(tasks, groups, message):
    with pytest.raises(ArgoError, match=message):
        make_problem(sequence(*tasks, groups=groups))


def test_measurements_stay_before_or_after_the_until_of_a_group():
    group = Group(name="G", start="M2", end="M3", max_repeat_count=3, until=above(1, "").conditions)
    planned = make_problem(
        sequence(measure(1), measure(2), measure(3), measure(4), groups=(group,))
    )
    assert "checkpoint 1 is measured before checkpoint 3 decides on it" in kept_orders(planned)
    assert "'G' is assumed to have as many rounds as it may have" in planned.reasons


def test_a_mission_can_not_charge():
    mission = sequence(measure(1), measure(2))
    time = np.full((5, 4), 10.0)
    planned = route_problem(
        mission,
        TravelMatrix(
            ("M1", "M2", "DOCK"), time, time, np.array([2.0, 2.0, 0.0, 0.0]),
            ("docking station 1",), battery=25.0, charging=3600.0, unit=1.0,
        ),
    )  # fmt: skip
    assert planned.problem.battery.capacity == 25
    assert not evaluate(planned.problem, planned.written).feasible
    with pytest.raises(ArgoError, match="charges at docking station 1 when the robot has done"):
        apply_route(planned, Tour((0, 1), {1: 0}))


def test_a_mission_that_does_not_dock_ends_with_one_task():
    mission = sequence(measure(1, above(1, "M2"), Transition(target="M3")), measure(2), measure(3),
                  docked=False)  # fmt: skip
    planned = make_problem(mission, budget=60.0)
    assert kept_orders(planned) == [
        "the mission can't end with checkpoint 1, which can lead to different tasks"
    ]
    assert [v.mandatory for v in planned.problem.visits] == [False, True]
    assert planned.problem.travel[1, 2] == 0


@pytest.mark.rule("T6")
def test_a_task_keeps_the_speed_of_the_drive_to_it_in_any_order():
    planned = make_problem(sequence(measure(1, velocity=0.2), measure(2)))
    speeds = {t.name: t.velocity for t in apply_route(planned, Tour((1, 0))).tasks}
    assert speeds == {"M2": None, "M1": 0.2, "DOCK": None}


def test_an_unreachable_task_is_refused():
    with pytest.raises(ArgoError, match="no execution path leads to task 'M2'"):
        make_problem(sequence(measure(1, Transition(target="DOCK")), measure(2)))


def test_a_mission_without_tasks_is_not_written():
    planned = make_problem(sequence(measure(1), measure(2), docked=False), budget=1.0)
    with pytest.raises(ArgoError, match="leaves out every task"):
        apply_route(planned, Tour(()))
    docked = make_problem(sequence(measure(1), measure(2)), budget=1.0)
    assert [t.name for t in apply_route(docked, Tour(())).tasks] == ["DOCK"]


def test_an_order_that_breaks_a_rule_is_not_written():
    planned = make_problem(sequence(measure(1), measure(2)), before=[(1, 2)])
    with pytest.raises(ArgoError, match="checkpoint 1 before checkpoint 2"):
        apply_route(planned, Tour((1, 0)))


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("20 min", 1200), ("20min", 1200), ("1 h 30 min", 5400), ("90", 90), ("1.5 h", 5400),
     ("20'", 1200), ("2 minutes 5 s", 125), ("1h", 3600), ("00:12:30", 750), ("1:02:03", 3723)],
)  # fmt: skip
def test_durations_are_read(text, seconds):
    assert parse_seconds(text) == seconds


@pytest.mark.parametrize(
    "text", ["", "soon", "-5 min", "5 miles", "5 s 2 min", "-3 min", "3 min 4 min"]
)
def test_text_that_is_no_duration_is_refused(text):
    with pytest.raises(ArgoError, match="20 min"):
        parse_seconds(text)


def test_a_clock_that_has_two_meanings_is_refused_as_in_scripts():
    with pytest.raises(ArgoError, match="can be read as 12 min 30 s or as 12 h 30 min"):
        parse_seconds("12:30")


@pytest.mark.rule("M10")
def test_precedences_are_kept_and_written():
    mission = sequence(measure(1), measure(2), measure(3), before=(("M3", "M1"), ("M2", "DOCK")))
    planned = route_problem(mission, matrix(mission))
    assert [(p.sequence, p.words) for p in planned.problem.precedences] == [
        ((2, 0), "checkpoint 3 before checkpoint 1")
    ]
    requirements = Requirements(before=((2, 3, 1),))
    planned = route_problem(mission, matrix(mission), requirements)
    changed = apply_route(planned, Tour((1, 2, 0)))
    assert changed.before == (*mission.before, ("M2", "M3"))
    with pytest.raises(ArgoError, match="checkpoint 3 before checkpoint 1"):
        apply_route(route_problem(mission, matrix(mission)), Tour((0, 1, 2)))
