"""Durations and energy of missions small enough to count by hand."""

import pytest

from argo_compiler.analysis import analyse
from argo_compiler.il import Group, Stop
from tests.argo_compiler.analysis.building import CATALOG, Steady, mission, task, way


def bounds(*tasks, **more):
    found = analyse(mission(*tasks, **more), CATALOG, Steady())
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
    ways = task("Am1", way("End", "1 < 5"), "B")
    assert bounds(ways, "B", "C", "End") == (22, 42)
    # The long side alone is left if no reading leads to the other.
    assert bounds(task("Am1", way("End", "1 < 0"), "B"), "B", "C", "End") == (42, 42)


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
    # A measurement alone takes 2 s; the way back and on again 10 s and 12 s, cleaning up 1 s.
    assert (least, most) == (35 + 2, 35 + 1 + 10 + 12)


def test_the_clock_of_the_next_group_runs_while_the_robot_cleans_up():
    least, most = bounds(
        *["A", "B", "C", "D", "End"],
        groups=[
            group("G", "A", "B", max_repeat_duration=35, **HARD),
            group("H", "C", "D", max_repeat_duration=20, **SOFT),
        ],
    )
    # The first round of H takes 10 to 31 s, the next one 20 s, and it begins before 20 s are over.
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
    middle = task("S", way("B", "1 < 5"), "A")
    found = bounds("Xm1", middle, "A", "B", "C", groups=[group("G", "A", "C", max_repeat_count=2)])
    assert found == (12 + 10 + 20 + 30, 12 + 10 + 30 + 30)


def test_a_group_may_be_left_in_any_round():
    leave = task("Am1", way("End", "1 < 5"), "B")
    found = bounds(leave, "B", "End", groups=[group("G", "Am1", "B", max_repeat_count=3)])
    # At once, or after three whole rounds, the last one of which could also be left.
    assert found == (22, 3 * 22 + 10)


def test_an_endless_group_that_may_be_left_has_no_longest_duration():
    leave = task("Am1", way("End", "1 < 5"), "B")
    assert bounds(leave, "B", "End", groups=[group("G", "Am1", "B")]) == (22, None)


def test_a_loop_within_a_time_limit_is_limited():
    loop = [task("Am1", way("Am1", "1 < 5"), "B"), "B", "End"]
    assert bounds(*loop) == (32, None)
    least, most = bounds(*loop, groups=[group("G", "Am1", "B", max_repeat_duration=60, **HARD)])
    assert (least, most) == (60, 60 + 1 + 12 + 10)


def test_the_path_says_how():
    found = analyse(
        mission("A", "B", "C", groups=[group("G", "A", "B", max_repeat_count=3)]),
        CATALOG,
        Steady(),
    )
    assert found.duration is not None
    assert [(s.words, s.until) for s in found.duration.least.path] == [
        ("'G' x 3 rounds", 60),
        ("C", 70),
    ]
    assert found.energy is not None
    assert found.energy.most.value == 7
