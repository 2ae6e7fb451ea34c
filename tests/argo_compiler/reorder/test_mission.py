"""Missions as route problems and back: an executor carries out what was rewritten."""

from collections import Counter
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.hfsm import Outcome
from argo_compiler.il import Action, Mission, Order
from argo_compiler.reorder.mission import route_problem
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.route import evaluate, suggest_route
from argo_compiler.route.problem import Tour
from tests.argo_compiler.reorder.written import (
    OBJECTS,
    carry_out,
    missions,
    random_ways,
    shuffled,
    with_branches,
    with_waits,
    with_windows,
)
from tests.conftest import examples
from tests.mission_parts import assume_sound, groups_over, starts, task_names, tasks_named

STRAIGHT = ("task", "task", "task", "group")
SEEDS = st.integers(0, 2**32 - 1)
SHOWN = st.fixed_dictionaries(
    {o: st.lists(st.integers(0, 9), min_size=1, max_size=4) for o in OBJECTS}
)
LIMITS = st.none() | st.floats(1.0, 1e6)


@st.composite
def wild_missions(draw):
    """Transitions anywhere, groups anywhere, and no group that lasts for a time: how many rounds
    such a one has depends on the way."""
    names = draw(task_names(least=2))
    tasks = [draw(tasks_named(name, names, i, failures=False)) for i, name in enumerate(names)]
    groups = (
        g.model_copy(update={"max_repeat_duration": 0.0}) for g in draw(groups_over(names, False))
    )
    tasks = (*draw(starts(names)), *tasks)
    return assume_sound(Mission(order=Order.ANY, tasks=tasks, groups=tuple(groups)))


def reordered(mission, seed):
    """Return random ways, the mission's problem with them, and a random order that it allows."""
    rng = np.random.default_rng(seed)
    ways = random_ways(mission, rng)
    planned = route_problem(mission, ways)
    return ways, planned, shuffled(planned, rng)


def require_the_same_done(mission, values, seed, fails=frozenset()):
    """In another order that the problem allows, the same tasks are carried out as often."""
    ways, planned, route = reordered(mission, seed)
    event("moved" if route != planned.written else "as written")
    changed = apply_route(planned, route)
    assert len(check(changed)) <= len(check(mission))
    assert {t.name for t in changed.tasks} == {t.name for t in mission.tasks}
    before, after = (carry_out(m, ways, values, fails=fails) for m in (mission, changed))
    assume(before.finished)
    assert after.finished
    assert Counter(after.tasks) == Counter(before.tasks)


@given(missions(), SHOWN, SEEDS)
@settings(max_examples=examples(60))
def test_another_order_does_the_same_tasks(mission, values, seed):
    require_the_same_done(mission, values, seed)


@given(missions().flatmap(with_waits).flatmap(with_branches), SHOWN, SEEDS, st.data())
@settings(max_examples=examples(60))
def test_another_order_does_the_same_tasks_where_some_fail(mission, values, seed, data):
    assume_sound(mission)
    names = [t.name for t in mission.tasks if t.action in (Action.MEASURE, Action.WAYPOINT)]
    fails = data.draw(st.sets(st.sampled_from(names)))
    try:
        require_the_same_done(mission, values, seed, fails)
    except ArgoError as error:
        event(str(error)[:20])


@given(wild_missions(), SHOWN, SEEDS)
@settings(max_examples=examples(60))
def test_any_mission_is_refused_or_kept_the_same(mission, values, seed):
    try:
        require_the_same_done(mission, values, seed)
    except ArgoError as error:
        event(str(error)[:20])


@given(missions(), SEEDS)
@settings(max_examples=examples(40))
def test_the_written_order_gives_the_same_mission(mission, seed):
    planned = route_problem(mission, random_ways(mission, np.random.default_rng(seed)))
    assert evaluate(planned.problem, planned.written).feasible
    assert apply_route(planned, planned.written) == mission


@given(missions(kinds=STRAIGHT, most=6, lasting=True), SEEDS)
@settings(max_examples=examples(60))
def test_a_mission_takes_as_long_as_its_route(mission, seed):
    ways, planned, route = reordered(mission, seed)
    done = carry_out(apply_route(planned, route), ways, {o: [0] for o in OBJECTS})
    assert done.finished
    assert done.time == evaluate(planned.problem, route).duration
    visits = planned.visits
    names = [visits.spine.name(visits.stops[k].entry) for k in route.order]
    assert [name for name in dict.fromkeys(done.tasks) if name != "DOCK"] == names


@given(missions(kinds=STRAIGHT, most=6).flatmap(with_waits).flatmap(with_windows), SEEDS)
@settings(max_examples=examples(80))
@pytest.mark.rule("W4", "W5")
def test_waits_and_windows_are_kept_as_promised(mission, seed):
    ways, planned, route = reordered(mission, seed)
    assume(evaluate(planned.problem, planned.written).feasible)
    event("moved" if route != planned.written else "as written")
    event("waits" if evaluate(planned.problem, route).waiting else "waits for nothing")
    done = carry_out(apply_route(planned, route), ways, {o: [0] for o in OBJECTS})
    assert done.outcome is Outcome.COMPLETED
    assert done.time == evaluate(planned.problem, route).duration


@given(missions(kinds=("task",), most=5).flatmap(with_windows), SEEDS)
@settings(max_examples=examples(40))
def test_the_best_of_all_orders_is_the_suggested_one(mission, seed):
    ways = random_ways(mission, np.random.default_rng(seed))
    planned = route_problem(mission, ways)
    runs = []
    for order in permutations(range(len(planned.visits.stops))):
        route = Tour(order)
        if evaluate(planned.problem, route).feasible:
            done = carry_out(apply_route(planned, route), ways, {o: [0] for o in OBJECTS})
            assert done.outcome is Outcome.COMPLETED
            runs.append(done.time)
    found = suggest_route(planned.problem, 5.0)
    event("there is an order" if runs else "there is none")
    assert (found.route is None) == (not runs)
    if runs:
        best = carry_out(apply_route(planned, found.route), ways, {o: [0] for o in OBJECTS})
        assert best.time == min(runs)


@given(missions(calm=True), SHOWN, SEEDS)
@settings(max_examples=examples(60))
def test_no_branch_takes_longer_than_reckoned(mission, values, seed):
    ways, planned, route = reordered(mission, seed)
    done = carry_out(apply_route(planned, route), ways, values)
    assert done.finished
    assert done.time <= evaluate(planned.problem, route).duration


@given(missions(), LIMITS, LIMITS, SHOWN, SEEDS)
@settings(max_examples=examples(60))
def test_what_is_left_out_is_named_and_not_done(mission, most, budget, values, seed):
    mission = mission.model_copy(update={"max_duration": most})
    rng = np.random.default_rng(seed)
    ways = random_ways(mission, rng)
    planned = route_problem(mission, ways, Requirements(budget=budget or 1e6))
    kept = [k for k in planned.written.order if rng.random() < 0.6]
    for _, members in planned.visits.circuits:
        if not set(members) <= set(kept):
            kept = [k for k in kept if k not in members]
    route = Tour(tuple(kept))
    assume(kept and evaluate(replace(planned.problem, max_duration=None), route).feasible)
    changed = apply_route(planned, route)
    assert not has_errors(check(changed))
    stops = planned.visits.stops
    gone = {k for k in planned.written.order if k not in kept}
    event("left out" if gone else "all kept")
    names = {planned.visits.spine.name(leaf) for k in gone for leaf in stops[k].leaves}
    assert {t.name for t in changed.tasks} == {t.name for t in mission.tasks} - names
    assert changed.left_out == tuple(t.name for t in mission.tasks if t.name in names)
    assert changed.max_duration == min(limit for limit in (most, budget or 1e6) if limit)
    endless = changed.model_copy(update={"max_duration": None})
    assert not names & set(carry_out(endless, ways, values).tasks)
