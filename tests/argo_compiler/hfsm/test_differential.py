"""Comparison of the machine with a reference interpreter of the IL, on random missions."""

from dataclasses import replace
from itertools import tee

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.hfsm import ActionStopped, Executor, Hfsm, Pause, Progress, Resume, Tick, lower
from argo_compiler.hfsm.model import RETURN
from argo_compiler.il import Action
from tests.argo_compiler.hfsm.random_missions import busy_cases, cases, missions
from tests.argo_compiler.hfsm.world import STEPS, Ticks, World, compare
from tests.conftest import examples
from tests.mission_parts import assume_sound


def machine(mission):
    return lower(assume_sound(mission))


@settings(max_examples=examples(100))
@given(cases(), st.sampled_from(Ticks))
def test_machine_does_what_the_rules_say(case, ticks):
    machine(case.mission)
    compare(case, ticks)


@settings(max_examples=examples(100))
@given(busy_cases())
def test_interruptions_are_what_the_rules_say(case):
    machine(case.mission)
    compare(case, Ticks.DEADLINES)


@settings(max_examples=examples(40))
@given(cases())
def test_more_ticks_change_nothing(case):
    hfsm = machine(case.mission)
    worlds = [World(Executor(hfsm), case, ticks) for ticks in (Ticks.DEADLINES, Ticks.SECONDS)]
    for world in worlds:
        world.run()
    until = min(world.now for world in worlds)
    seen = [[one for one in world.seen if one[0] < until] for world in worlds]
    assert seen[0] == seen[1]


@pytest.mark.rule("H1", "H2")
@settings(max_examples=examples(60))
@given(cases(), st.integers(0, 30), st.sampled_from([0, 0, 7]))
def test_restored_machine_goes_on_alike(case, count, away):
    """A restored machine does the same as one that a person paused for the same time."""
    hfsm = machine(case.mission)
    world = World(Executor(hfsm), case)
    world.start()
    for _ in range(count):
        if not world.step():
            break
    executor = world.executor
    if not executor.paused:
        world.execute(executor.handle(Pause(), world.now))
    while world.running:
        world.ends_at = world.now
        world.end_event = ActionStopped(world.running.task.name, id=world.running.id)
        world.step()
    text = executor.progress().model_dump_json()
    world.now += away
    executor.handle(Tick(), world.now)
    later = 1000
    other = Executor.restore(
        Hfsm.model_validate_json(hfsm.model_dump_json()),
        Progress.model_validate_json(text),
        later,
        away,
    )
    other.start(later)
    assert Progress.model_validate_json(other.progress().model_dump_json()) == executor.progress()
    rest = World(other, case, now=later)
    rest.results, world.results = tee(world.results)
    shift = later - world.now
    world.script = [(at + away, scripted) for at, scripted in world.script]
    rest.script = [(at + shift, scripted) for at, scripted in world.script]
    world.script.insert(0, (world.now, Resume()))
    rest.script.insert(0, (later, Resume()))
    before = len(executor.trace), len(other.trace)
    world.seen = []
    for _ in range(STEPS):
        going = world.step()
        assert rest.step() == going
        if not going:
            break
        assert rest.seen == [(at + shift, *what) for at, *what in world.seen]
        assert other.progress() == executor.progress()
    expected = [shifted(entry, shift) for entry in executor.trace[before[0] :]]
    assert list(other.trace[before[1] :]) == expected


def shifted(entry, seconds):
    """Return an entry of the trace with all its times some seconds later."""
    rounds = tuple(
        one if one.due is None else one._replace(due=one.due + seconds) for one in entry.rounds
    )
    return replace(entry, time=entry.time + seconds, rounds=rounds)


@settings(max_examples=60)
@given(missions())
def test_every_state_carries_what_it_came_from(mission):
    hfsm = machine(mission)
    tasks = [task for task in mission.tasks if task.action is not Action.START]
    assert [leaf.task for leaf in hfsm.leaves if leaf.id != RETURN] == tasks
    assert {c.name for c in hfsm.composites[1:]} == {group.name for group in mission.groups}
    for composite in hfsm.composites[1:]:
        assert composite.id in next(
            parent.children for parent in hfsm.composites if parent.id == composite.parent
        )
