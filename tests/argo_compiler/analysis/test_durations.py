"""Durations and energy of missions that are small enough to compute by hand."""

import pytest

from argo_compiler.analysis import Leg, analyse
from argo_compiler.il import (
    Afterwards,
    EventKind,
    Group,
    Mode,
    OnFailure,
    Reaction,
    Response,
    Stop,
    TimeWindow,
)
from tests.argo_compiler.analysis.building import (
    CATALOG,
    DOCK,
    ConstantTravel,
    compare,
    mission,
    task,
    transition,
)
from tests.mission_writing import wait


def bounds(*tasks, **more):
    found = analyse(mission(*tasks, **more), CATALOG, ConstantTravel())
    assert found.duration is not None
    return found.duration.least.value, found.duration.most.value


def group(name, start, end, **limits):
    return Group(name=name, start=start, end=end, **limits)


SOFT, HARD = {"stop": Stop.SOFT}, {"stop": Stop.HARD}


def test_one_task_after_the_other():
    assert bounds("A", "Bm1", "C") == (32, 32)
    fast = task("A", "B", velocity=2.0)
    assert bounds(fast, "B", "C") == (25, 25)


def test_a_branch_has_a_short_and_a_long_side():
    ways = task("Am1", transition("End", "1 < 5"), "B")
    assert bounds(ways, "B", "C", "End") == (22, 42)
    # The long side alone is left if no reading leads to the other.
    assert bounds(task("Am1", transition("End", "1 < 0"), "B"), "B", "C", "End") == (42, 42)


@pytest.mark.parametrize(
    ("limits", "expected"),
    [
        ({"max_repeat_count": 1}, (30, 30)),
        ({"max_repeat_count": 3}, (70, 70)),
        # Rounds end after 20, 40, 60 s.
        ({"max_repeat_duration": 30, **SOFT}, (50, 50)),
        ({"max_repeat_duration": 40, **SOFT}, (50, 50)),
        ({"max_repeat_duration": 41, **SOFT}, (70, 70)),
        ({"max_repeat_duration": 30, "max_repeat_count": 1, **SOFT}, (30, 30)),
        ({"max_repeat_duration": 90, "max_repeat_count": 2, **SOFT}, (50, 50)),
        ({"max_repeat_duration": 90, "max_repeat_count": 2, **HARD}, (50, 50)),
    ],
)
def test_rounds(limits, expected):
    assert bounds("A", "B", "End", groups=[group("G", "A", "B", **limits)]) == expected


def test_a_hard_stop_leaves_at_its_time_from_wherever_the_robot_is():
    least, most = bounds(
        "A", "B", "Cm1", groups=[group("G", "A", "B", max_repeat_duration=35, **HARD)]
    )
    # At least only the measurement, 2 s. At most cleaning up, 1 s, the rest of the drive, 10 s,
    # and the drive to C with its measurement, 12 s.
    assert (least, most) == (35 + 2, 35 + 1 + 10 + 12)


def test_the_clock_of_the_next_group_runs_while_the_robot_cleans_up():
    least, most = bounds(
        *["A", "B", "C", "D", "End"],
        groups=[
            group("G", "A", "B", max_repeat_duration=35, **HARD),
            group("H", "C", "D", max_repeat_duration=20, **SOFT),
        ],
    )
    # The first round of H takes 10 to 31 s, the next one 20 s; it starts before 20 s are over.
    assert (least, most) == (35 + 20 + 10, 35 + 40 + 10)


def test_rounds_in_rounds():
    groups = [
        group("G", "A", "D", max_repeat_count=2),
        group("G/H", "B", "C", max_repeat_count=3),
    ]
    assert bounds("A", "B", "C", "D", groups=groups) == (160, 160)
    same_end = [
        group("G", "A", "C", max_repeat_count=2),
        group("G/H", "B", "C", max_repeat_count=3),
    ]
    assert bounds("A", "B", "C", groups=same_end) == (140, 140)


def test_a_group_entered_in_the_middle_has_a_short_first_round():
    middle = task("S", transition("B", "1 < 5"), "A")
    found = bounds("Xm1", middle, "A", "B", "C", groups=[group("G", "A", "C", max_repeat_count=2)])
    assert found == (12 + 10 + 20 + 30, 12 + 10 + 30 + 30)


def test_a_group_may_be_left_in_any_round():
    leave = task("Am1", transition("End", "1 < 5"), "B")
    found = bounds(leave, "B", "End", groups=[group("G", "Am1", "B", max_repeat_count=3)])
    # At once, or after three complete rounds, the last of which could also be left.
    assert found == (22, 3 * 22 + 10)


def test_an_endless_group_that_may_be_left_has_no_longest_duration():
    leave = task("Am1", transition("End", "1 < 5"), "B")
    assert bounds(leave, "B", "End", groups=[group("G", "Am1", "B")]) == (22, None)


def test_a_loop_within_a_time_limit_is_limited():
    loop = [task("Am1", transition("Am1", "1 < 5"), "B"), "B", "End"]
    assert bounds(*loop) == (32, None)
    least, most = bounds(*loop, groups=[group("G", "Am1", "B", max_repeat_duration=60, **HARD)])
    assert (least, most) == (60, 60 + 1 + 12 + 10)


def test_the_path_lists_tasks_and_rounds():
    found = analyse(
        mission("A", "B", "C", groups=[group("G", "A", "B", max_repeat_count=3)]),
        CATALOG,
        ConstantTravel(),
    )
    assert found.duration is not None
    assert [(s.task_or_rounds_text, s.until) for s in found.duration.least.path] == [
        ("'G' x 3 rounds", 60),
        ("C", 70),
    ]
    assert found.energy is not None
    assert found.energy.most.value == 7


def test_a_wait_lasts_its_time_or_up_to_its_limit():
    assert bounds("A", wait("W", "B", duration=5), "B") == (25, 25)
    event = EventKind.ALL_CLEAR
    assert bounds("A", wait("W", "B", event=event, limit=7), "B") == (20, 27)
    assert bounds("A", wait("W", "B", event=event), "B") == (20, None)


def test_a_wait_that_fails_may_lead_elsewhere():
    branch = {"on_failure": OnFailure.BRANCH, "failure_target": "C"}
    gives_up = wait("W", "End", event=EventKind.ALL_CLEAR, limit=7, **branch)
    assert bounds("A", gives_up, task("C", "End"), "End") == (20, 37)


def test_where_paths_join_the_robot_is_where_it_came_from():
    """A WAIT of no time leaves the robot where it is; the next drive starts there."""
    join = wait("J", "Bm1", duration=0)
    # Both measure the same checkpoint, the second time without a drive.
    assert bounds(task("Am1", "J"), join, task("Bm1")) == (14, 14)


def test_rounds_with_fixed_starts_do_not_drift():
    # A round takes 20 s; the last one starts at 2 x 60 s, or when the previous one has ended.
    three = {"max_repeat_count": 3}
    assert bounds("A", "B", "C", groups=[group("G", "A", "B", every=60, **three)]) == (150, 150)
    assert bounds("A", "B", "C", groups=[group("G", "A", "B", every=15, **three)]) == (70, 70)


def test_no_round_begins_that_is_due_too_late():
    limited = group("G", "A", "B", every=60, max_repeat_duration=120, **SOFT)
    # Round 2 is due after 60 s and takes 20; round 3 would be due when the time is up.
    assert bounds("A", "B", "C", groups=[limited]) == (90, 90)


def test_rounds_until_a_condition_holds():
    found = bounds(
        "Am1",
        "B",
        "C",
        groups=[group("G", "Am1", "B", max_repeat_count=3, until=(compare("1 < 5"),))],
    )
    assert found == (22 + 10, 3 * 22 + 10)
    endless = group("G", "Am1", "B", until=(compare("1 < 5"),))
    assert bounds("Am1", "B", "C", groups=[endless]) == (32, None)


def test_a_window_is_waited_for():
    assert bounds("A", task("B", "C", window=TimeWindow(earliest=50)), "C") == (60, 60)
    assert bounds("A", task("B", "C", window=TimeWindow(earliest=15)), "C") == (30, 30)


def test_a_hard_window_ends_a_task():
    missed = task("B", "C", window=TimeWindow(latest=15, missed_target="D"))
    # Interrupted on the way: from there to B and then to D takes 20 s at most, after cleaning up.
    assert bounds("A", missed, task("C"), "D") == (15, 15 + 1 + 20)


def test_a_time_out_need_not_come_after_a_whole_round():
    """T1 may be repeated until the time is up, so that no round is completed."""

    class Costly(ConstantTravel):
        def leg_with_action(self, origin, task, velocity):  # noqa: ARG002
            return Leg(2.0, 10.0 if task.name == "T2" else 0.1, task.name)

    plan = mission(
        task("T0m1", transition("T2", "1 > 3"), "T1"),
        task("T1", "T1"),
        task("T2"),
        groups=[group("G", "T0m1", "T2", max_repeat_duration=8, max_repeat_count=3, **HARD)],
    )
    found = analyse(plan, CATALOG, Costly(battery=5.0))
    assert found.energy.least.value <= 0.4
    assert "analysis.battery-exceeded" not in {d.code for d in found.diagnostics}


@pytest.mark.rule("T6")
def test_the_speed_of_a_drive_is_that_of_its_target():
    fast = task("B", "C", velocity=2.0)
    assert bounds("A", fast, "C") == (10 + 5 + 10,) * 2


def worst(*tasks, **more):
    found = analyse(mission(*tasks, **more), CATALOG, ConstantTravel()).duration_with_failures
    assert found is not None
    return found.value


HOME = Reaction(event=EventKind.TIME_UP, response=Response.RETURN)


def test_failures_take_no_longer_than_all_attempts():
    # One action of 10 s, and a clean-up; with a retry twice that.
    assert worst("A") == 11
    assert worst(task("A", retries=1)) == 22
    assert worst(task("A", "A")) is None


def test_when_the_time_is_up_only_the_way_home_is_left():
    loop = task("Am1", transition("Am1", "1 < 5"))
    # 100 s, cleaning up, the rest of the drive to A with its 2 s, and the drive from there.
    assert worst(loop, max_duration=100, dock=DOCK, reactions=(HOME,)) == 100 + 1 + 12 + 10
    assert worst(loop, max_duration=100, dock=DOCK) is None
    again = HOME.model_copy(update={"afterwards": Afterwards.RESUME})
    assert worst(loop, max_duration=100, dock=DOCK, reactions=(again,)) is None


def test_a_reaction_of_higher_rank_may_keep_the_robot_from_going_home():
    loop = task("Am1", transition("Am1", "1 < 5"))
    alarm = Reaction(event=EventKind.GAS_LEAK, response=Response.PAUSE, until=EventKind.ALL_CLEAR)
    assert worst(loop, max_duration=100, dock=DOCK, reactions=(HOME, alarm)) is None
    lower = alarm.model_copy(update={"priority": 1})
    assert worst(loop, max_duration=100, dock=DOCK, reactions=(HOME, lower)) == 123
    held = lower.model_copy(update={"hold_limit": 5.0})  # then it waits for a person
    assert worst(loop, max_duration=100, dock=DOCK, reactions=(HOME, held)) is None
    supervised = {"mode": Mode.SUPERVISORY, "max_duration": 100, "dock": DOCK}
    assert worst(loop, reactions=(HOME,), **supervised) is None


def test_an_action_that_begins_when_the_time_is_up_has_not_ended():
    """B takes no time but needs energy; the stop comes before its end."""

    class Quick(ConstantTravel):
        def leg_with_action(self, origin, task, velocity):  # noqa: ARG002
            return Leg(0.0 if task.name == "B" else 10.0, 1.0, task.name)

    rounds = group("G", "A", "B", max_repeat_duration=10, **HARD)
    found = analyse(mission("A", "B", groups=[rounds]), CATALOG, Quick())
    assert found.energy.least.value <= 1
