"""Missions are converted to route problems and back, and the rewritten mission is executed."""

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
from argo_compiler.reorder.mission_problem import route_problem
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.route import evaluate, suggest_route
from argo_compiler.route.problem import Tour
from tests.argo_compiler.reorder.generated_missions import (
    OBJECTS,
    missions,
    random_matrix,
    random_order,
    run_mission,
    with_branches,
    with_waits,
    with_windows,
)
from tests.conftest import examples
from tests.mission_parts import assume_sound, groups_over, starts, task_names, tasks_named

STRAIGHT = ("task", "task", "task", "group")
SEEDS = st.integers(0, 2**32 - 1)
VALUES = st.fixed_dictionaries(
    {o: st.lists(st.integers(0, 9), min_size=1, max_size=4) for o in OBJECTS}
)
LIMITS = st.none() | st.floats(1.0, 1e6)


@st.composite
def wild_missions(draw):
    """Draw a mission with transitions and groups anywhere, but without durations of groups.

    With a duration, the number of rounds would depend on the drives.
    """
    names = draw(task_names(least=2))
    tasks = [draw(tasks_named(name, names, i, failures=False)) for i, name in enumerate(names)]
    groups = (
        g.model_copy(update={"max_repeat_duration": 0.0}) for g in draw(groups_over(names, False))
    )
    tasks = (*draw(starts(names)), *tasks)
    return assume_sound(Mission(order=Order.ANY, tasks=tasks, groups=tuple(groups)))


def reordered(mission, seed):
    """Return random travel times, the mission's problem with them, and a random feasible order."""
    rng = np.random.default_rng(seed)
    matrix = random_matrix(mission, rng)
    planned = route_problem(mission, matrix)
    return matrix, planned, random_order(planned, rng)


def require_same_tasks_done(mission, values, seed, fails=frozenset()):
    """In another feasible order, the same tasks are executed as often."""
    matrix, planned, route = reordered(mission, seed)
    event("moved" if route != planned.written else "as written")
    changed = apply_route(planned, route)
    assert len(check(changed)) <= len(check(mission))
    assert {t.name for t in changed.tasks} == {t.name for t in mission.tasks}
    before, after = (run_mission(m, matrix, values, fails=fails) for m in (mission, changed))
    assume(before.finished)
    assert after.finished
    assert Counter(after.tasks) == Counter(before.tasks)


@given(missions(), VALUES, SEEDS)
@settings(max_examples=examples(60))
def test_another_order_does_the_same_tasks(mission, values, seed):
    require_same_tasks_done(mission, values, seed)


@given(missions().flatmap(with_waits).flatmap(with_branches), VALUES, SEEDS, st.data())
@settings(max_examples=examples(60))
def test_another_order_does_the_same_tasks_where_some_fail(mission, values, seed, data):
    assume_sound(mission)
    names = [t.name for t in mission.tasks if t.action in (Action.MEASURE, Action.WAYPOINT)]
    fails = data.draw(st.sets(st.sampled_from(names)))
    try:
        require_same_tasks_done(mission, values, seed, fails)
    except ArgoError as error:
        event(str(error)[:20])


@given(wild_missions(), VALUES, SEEDS)
@settings(max_examples=examples(60))
def test_any_mission_is_refused_or_does_the_same_tasks(mission, values, seed):
    try:
        require_same_tasks_done(mission, values, seed)
    except ArgoError as error:
        event(str(error)[:20])


@given(missions(), SEEDS)
@settings(max_examples=examples(40))
def test_the_written_order_gives_the_same_mission(mission, seed):
    planned = route_problem(mission, random_matrix(mission, np.random.default_rng(seed)))
    assert evaluate(planned.problem, planned.written).feasible
    assert apply_route(planned, planned.written) == mission


@given(missions(kinds=STRAIGHT, most=6, lasting=True), SEEDS)
@settings(max_examples=examples(60))
def test_a_mission_takes_as_long_as_its_route(mission, seed):
    matrix, planned, route = reordered(mission, seed)
    run = run_mission(apply_route(planned, route), matrix, {o: [0] for o in OBJECTS})
    assert run.finished
    assert run.time == evaluate(planned.problem, route).duration
    visits = planned.visits
    names = [visits.chain.name(visits.task_units[k].entry) for k in route.order]
    assert [name for name in dict.fromkeys(run.tasks) if name != "DOCK"] == names


@given(missions(kinds=STRAIGHT, most=6).flatmap(with_waits).flatmap(with_windows), SEEDS)
@settings(max_examples=examples(80))
@pytest.mark.rule("W4", "W5")
def test_waits_and_windows_are_kept_as_promised(mission, seed):
    matrix, planned, route = reordered(mission, seed)
    assume(evaluate(planned.problem, planned.written).feasible)
    event("moved" if route != planned.written else "as written")
    event("waits" if evaluate(planned.problem, route).waiting else "waits for nothing")
    run = run_mission(apply_route(planned, route), matrix, {o: [0] for o in OBJECTS})
    assert run.outcome is Outcome.COMPLETED
    assert run.time == evaluate(planned.problem, route).duration


@given(missions(kinds=("task",), most=5).flatmap(with_windows), SEEDS)
@settings(max_examples=examples(40))
def test_the_best_of_all_orders_is_the_suggested_one(mission, seed):
    matrix = random_matrix(mission, np.random.default_rng(seed))
    planned = route_problem(mission, matrix)
    runs = []
    for order in permutations(range(len(planned.visits.task_units))):
        route = Tour(order)
        if evaluate(planned.problem, route).feasible:
            run = run_mission(apply_route(planned, route), matrix, {o: [0] for o in OBJECTS})
            assert run.outcome is Outcome.COMPLETED
            runs.append(run.time)
    found = suggest_route(planned.problem, 5.0)
    event("there is an order" if runs else "there is none")
    assert (found.route is None) == (not runs)
    if runs:
        best = run_mission(apply_route(planned, found.route), matrix, {o: [0] for o in OBJECTS})
        assert best.time == min(runs)


@given(missions(calm=True), VALUES, SEEDS)
@settings(max_examples=examples(60))
def test_no_branch_takes_longer_than_computed(mission, values, seed):
    matrix, planned, route = reordered(mission, seed)
    run = run_mission(apply_route(planned, route), matrix, values)
    assert run.finished
    assert run.time <= evaluate(planned.problem, route).duration


@given(missions(), LIMITS, LIMITS, VALUES, SEEDS)
@settings(max_examples=examples(60))
def test_tasks_that_are_left_out_are_named_and_not_done(mission, most, budget, values, seed):
    mission = mission.model_copy(update={"max_duration": most})
    rng = np.random.default_rng(seed)
    matrix = random_matrix(mission, rng)
    planned = route_problem(mission, matrix, Requirements(budget=budget or 1e6))
    visited = [k for k in planned.written.order if rng.random() < 0.6]
    for _, members in planned.visits.group_units:
        if not set(members) <= set(visited):
            visited = [k for k in visited if k not in members]
    route = Tour(tuple(visited))
    assume(visited and evaluate(replace(planned.problem, max_duration=None), route).feasible)
    changed = apply_route(planned, route)
    assert not has_errors(check(changed))
    task_units = planned.visits.task_units
    left_out = {k for k in planned.written.order if k not in visited}
    event("left out" if left_out else "all kept")
    names = {planned.visits.chain.name(leaf) for k in left_out for leaf in task_units[k].leaves}
    assert {t.name for t in changed.tasks} == {t.name for t in mission.tasks} - names
    assert changed.left_out == tuple(t.name for t in mission.tasks if t.name in names)
    assert changed.max_duration == min(limit for limit in (most, budget or 1e6) if limit)
    endless = changed.model_copy(update={"max_duration": None})
    assert not names & set(run_mission(endless, matrix, values).tasks)
