"""Precedences (rule M10), compared with all runs through small missions."""

import random
from itertools import product

import pytest

from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.il import Mission, Order
from tests.conftest import examples
from tests.mission_writing import above, measure, way


def task(name, *targets):
    """Return a task with transitions to the targets; the last one is unconditional."""
    ways = (way(target, above("1", 5.0)) for target in targets[:-1])
    return measure(name, *ways, *targets[-1:], object_id="1")


ROW = (task("A", "B"), task("B", "C"), task("C"))


def found(mission):
    return [(f.code, f.severity) for f in check(mission) if "before" in (f.subject or "")]


@pytest.mark.rule("M10")
@pytest.mark.parametrize(
    ("before", "order", "expected"),
    [
        ((("A", "C"), ("B", "C")), Order.PRECISE, []),
        ((("C", "A"),), Order.PRECISE, [("il.order-broken", Severity.ERROR)]),
        ((("C", "A"),), Order.ANY, [("il.order-broken", Severity.WARNING)]),
        ((("A", "Z"),), Order.PRECISE, [("il.unknown-before", Severity.ERROR)]),
        ((("A", "L"), ("L", "C")), Order.PRECISE, []),
        ((("A", "A"),), Order.PRECISE, [("il.before-itself", Severity.ERROR)]),
        ((("A", "L"), ("L", "A")), Order.ANY, [("il.before-itself", Severity.ERROR)]),
    ],
)
def test_pairs(before, order, expected):
    mission = Mission(tasks=ROW, before=before, order=order, left_out=("L",))
    assert found(mission) == expected


@pytest.mark.rule("M10")
def test_an_order_that_may_break_a_pair_is_a_warning():
    tasks = (task("A", "C", "B"), task("B", "C"), task("C", "B", "D"), task("D"))
    mission = Mission(tasks=tasks, before=(("B", "C"),))
    assert found(mission) == [("il.order-broken", Severity.WARNING)]
    assert "'C' may come before it" in check(mission)[-1].message


@pytest.mark.rule("M10")
def test_pairs_that_may_be_broken_are_those_of_some_run():
    rng = random.Random(0)
    for _ in range(examples(300)):
        count = rng.randint(2, 6)
        names = [f"T{i}" for i in range(count)]
        tasks = [task(n, *rng.sample(names, rng.randint(0, min(2, count)))) for n in names]
        pairs = [p for p in product(names, names) if p[0] < p[1]]
        before = tuple(rng.sample(pairs, rng.randint(1, min(4, len(pairs)))))
        mission = Mission(tasks=tuple(tasks), before=before, order=Order.ANY)
        messages = [f.message for f in check(mission) if f.code == "il.order-broken"]
        said = {tuple(message.split("'")[1:4:2]) for message in messages}
        assert said == {pair for pair in before if _broken(mission, *pair)}, mission


def _broken(mission, first, second):
    """Return True if a path leads from the start to the second task and on to the first one."""
    ways = {t.name: [w.target for w in t.transitions] for t in mission.tasks}
    seen, pending = set(), [(mission.tasks[0].name, False)]
    while pending:
        name, passed = pending.pop()
        if (name, passed) in seen:
            continue
        seen.add((name, passed))
        if name == first:
            if passed:
                return True
            continue
        pending += [(way, passed or name == second) for way in ways[name]]
    return False
