"""Rounds with branches: what is carried out is what the sentences say, read anew by a small
interpreter that knows neither tasks nor groups."""

import random
import zlib
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.hfsm import (
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Executor,
    Occurred,
    Outcome,
    Tick,
    lower,
)
from argo_compiler.il import Action, EventKind, Mission
from argo_compiler.script import import_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.conftest import examples

STEPS = 150
HOME = "home"


# ---- protocols, and what they say


@dataclass
class Say:
    """What a step does: it checks the checkpoint of its number, or patrols. A branch is a
    checkpoint (`check #12`), a step (`go to step 3`), HOME or None: go on."""

    number: int
    patrol: bool = False
    cases: tuple | None = None
    """if it is above 5, and otherwise"""
    then: int | None = None
    """the step to go to in any case"""


@dataclass
class Rounds:
    """Steps that are repeated, and what is done after the last round if a value is above 5."""

    first: int
    last: int
    count: int
    after: tuple | None = None
    """the checkpoint whose value decides, and the branch"""
    inside: list["Rounds"] = field(default_factory=list)


def said(branch):
    if branch is None:
        return "go on"
    if branch == HOME:
        return "return to the docking station"
    kind, number = branch
    return f"check #{number}" if kind == "check" else f"go to step {number}"


def script(steps, rounds):
    lines = ["Mission Protocol", "Start area: 1"]
    for step in steps:
        words = f"patrol floor {step.number} twice" if step.patrol else f"check #{step.number}"
        if step.cases is not None:
            above, otherwise = step.cases
            words += f"; if it is above 5, {said(above)}"
            words += "" if otherwise is None else f"; otherwise {said(otherwise)}"
        if step.then is not None:
            words += f". Then go to step {step.then}"
        lines.append(f"{step.number}. {words}.")
        for r in sorted(rounds, key=lambda r: -r.first):
            if r.last == step.number:
                line = f"Repeat steps {r.first} to {r.last} {r.count} times"
                if r.after is not None:
                    line += f"; if #{r.after[0]} is above 5, {said(r.after[1])}"
                lines.append(f"{line}.")
    return "\n".join(lines)


def value(number, visit):
    return float(zlib.crc32(f"{number} {visit}".encode()) % 11)


class Ended(Exception):
    """The mission is over."""


class Led(Exception):
    """A branch leads to a step."""

    def __init__(self, step):
        self.step = step


class Interpreter:
    """Carries the sentences out. Mutable."""

    def __init__(self, steps, rounds):
        self.steps = {step.number: step for step in steps}
        self.whole = Rounds(1, len(steps), 1, inside=rounds)
        self.visits = Counter()
        self.values = {}
        self.done = []

    def run(self):
        with suppress(Ended):
            self.round(self.whole, 1)
        return self.done

    def do(self, what):
        if len(self.done) >= STEPS:
            raise Ended
        self.done.append(what)

    def check(self, number):
        self.do(number)
        self.visits[number] += 1
        self.values[number] = value(number, self.visits[number])

    def round(self, r, at):
        """One round from a step on."""
        while at <= r.last:
            inner = next((i for i in r.inside if i.first <= at <= i.last), None)
            try:
                if inner is None:
                    self.step(self.steps[at])
                    at += 1
                else:
                    self.all_rounds(inner, at)
                    at = inner.last + 1
                    self.behind(inner, r)
            except Led as led:
                if not r.first <= led.step <= r.last:
                    raise
                at = led.step

    def all_rounds(self, r, at):
        for k in range(r.count):
            self.round(r, at if k == 0 else r.first)

    def behind(self, inner, outer):
        """What comes after the last round."""
        if inner.after is not None:
            number, branch = inner.after
            if self.values.get(number, 0) > 5:
                self.branch(branch)
        step = self.steps[inner.last]
        if step.then is not None and (outer.last != inner.last or outer is self.whole):
            raise Led(step.then)

    def step(self, step):
        if step.patrol:
            for _ in range(8):
                self.do("W")
        else:
            self.check(step.number)
        if step.cases is not None:
            self.branch(step.cases[0 if self.values[step.number] > 5 else 1])
        ends = any(r.last == step.number for r in flat(self.whole.inside))
        if step.then is not None and not ends:
            raise Led(step.then)

    def branch(self, branch):
        if branch is None:
            return
        if branch == HOME:
            self.do(HOME)
            raise Ended
        kind, number = branch
        if kind == "check":
            self.check(number)
        else:
            raise Led(number)


# ---- random protocols


def random_protocol(rng):
    n = rng.randint(2, 6)
    steps = []
    extra = iter(range(11, 21))
    for number in range(1, n + 1):
        patrol = rng.random() < 0.15
        cases, then = None, None
        if not patrol and rng.random() < 0.6:
            above, otherwise = branch(rng, n, extra), branch(rng, n, extra)
            cases = (above, rng.choice([otherwise, None]))
        elif rng.random() < 0.1:
            then = rng.randint(1, n)
        steps.append(Say(number, patrol, cases, then))
    return steps, random_rounds(rng, steps, extra)


def branch(rng, n, extra):
    kind = rng.choice(["check", "check", "go", "go", "on", HOME])
    if kind == "check" and (number := next(extra, None)) is not None:
        return "check", number
    if kind == "go":
        return "go", rng.randint(1, n)
    return HOME if kind == HOME and rng.random() < 0.3 else None


def random_rounds(rng, steps, extra):
    kept = []
    for _ in range(rng.randint(1, 4)):
        first, last = sorted(rng.randint(1, len(steps)) for _ in range(2))
        apart = not any(f < first <= e < last or first < f <= last < e for f, e, _ in kept)
        if apart and all((first, last) != (f, e) for f, e, _ in kept):
            kept.append((first, last, rng.randint(1, 3)))
    top, around = [], []
    for first, last, count in sorted(kept, key=lambda r: (r[0], -r[1])):
        while around and around[-1].last < first:
            around.pop()
        r = Rounds(first, last, count)
        # What follows two rounds that end together, or a `then`, is not told apart here.
        alone = not any(e == last and f != first for f, e, _ in kept)
        if alone and steps[last - 1].then is None and rng.random() < 0.4:
            found = branch(rng, len(steps), extra)
            r.after = None if found is None else (rng.randint(first, last), found)
        (around[-1].inside if around else top).append(r)
        around.append(r)
    return top


def flat(rounds):
    return [r for top in rounds for r in (top, *flat(top.inside))]


def carried_out(mission: Mission):
    """What a mission does, as the interpreter tells it."""
    executor = Executor(lower(mission))
    executor.start(0.0)
    done, visits = [], Counter()
    while executor.running is not None and len(done) < STEPS:
        task = executor.running
        read = None
        if task.action is Action.MEASURE:
            number = int(task.object_id or 0)
            visits[number] += 1
            read = value(number, visits[number])
            done.append(number)
        else:
            done.append(HOME if task.name.startswith("DOCK") else "W")
        executor.handle(ActionSucceeded(task.name, read), 0.0)
    return done


@pytest.mark.rule("G14", "G5")
def test_what_is_carried_out_is_what_the_sentences_say() -> None:
    met: Counter[str] = Counter()

    @settings(max_examples=examples(400), deadline=None)
    @given(st.integers(0, 2**32))
    def compare(seed: int) -> None:
        steps, rounds = random_protocol(random.Random(seed))
        text = script(steps, flat(rounds))
        try:
            mission = import_script(text, CATALOG).mission
            done = carried_out(mission)
        except DiagnosticError as error:
            met.update({d.code for d in error.diagnostics if d.severity == "error"})
            return
        assert done == Interpreter(steps, rounds).run(), text
        met["run"] += 1
        met["joined"] += any(t.name.startswith("end of") for t in mission.tasks)
        met["decided behind"] += any(t.name.startswith("after") for t in mission.tasks)

    compare()
    assert met["run"] > 0.9 * (met.total() - met["joined"] - met["decided behind"])
    assert min(met["joined"], met["decided behind"]) > 0.1 * met["run"]


# ---- examples


def read(lines: str, catalog: Catalog) -> Mission:
    return import_script(f"Mission Protocol\nStart area: 1\n{lines}", catalog).mission


@pytest.mark.rule("G10", "G14")
@pytest.mark.parametrize("value", [4.0, 6.0])
def test_what_is_decided_behind_a_patrol_is_decided_when_its_time_is_up(
    value: float, catalog: Catalog
) -> None:
    lines = (
        "1. Check #1.\n2. Patrol floor 1 for 10 min.\n"
        "If #1 is above 5, check #2; otherwise check #3."
    )
    executor = Executor(lower(read(lines, catalog)))
    executor.start(0.0)
    executor.handle(ActionSucceeded("MEASURE 1", value), 1.0)
    executor.handle(ActionSucceeded("WAYPOINT 1"), 2.0)
    (cancelled,) = executor.handle(Tick(), 601.0)
    assert isinstance(cancelled, CancelAction)
    executor.handle(ActionStopped(cancelled.task), 602.0)
    assert executor.running is not None
    assert executor.running.name == ("MEASURE 2" if value > 5 else "MEASURE 3")


@pytest.mark.rule("G14")
def test_only_words_that_say_so_leave_a_round(catalog: Catalog) -> None:
    lines = "1. Check #1; if it is above 5, {}; otherwise {}.\n2. Repeat step 1 twice.\n3. Check #3"
    for above, otherwise in (
        ("go on", "check #2"),
        ("check #2", "check #4"),
        ("check #2", "go on"),
    ):
        mission = read(lines.format(above, otherwise), catalog)
        assert mission.groups[0].end == "end of 'Repeat 1'"
        inside = {t.name for t in mission.tasks if t.group}
        for task in mission.tasks:
            if task.name in inside and task.name != mission.groups[0].end:
                assert {way.target for way in task.transitions} <= inside
    away = read(lines.format("go to step 3", "check #2"), catalog)
    assert away.tasks[1].transitions[0].target == "MEASURE 3"
    at_once = read(lines.format("go on", "go to step 3"), catalog)
    assert [way.target for way in at_once.tasks[1].transitions] == [
        "end of 'Repeat 1'",
        "MEASURE 3",
    ]


@pytest.mark.rule("R7")
@pytest.mark.parametrize("priority", [1, 9])
def test_a_priority_of_a_script_does_not_hold_an_emergency_stop_back(
    priority: int, catalog: Catalog
) -> None:
    lines = (
        f"1. Check #1.\nOn low battery: return to the docking station, priority {priority}.\n"
        "In case of an emergency stop, abort the mission, priority 3."
    )
    executor = Executor(lower(read(lines, catalog)))
    executor.start(0.0)
    executor.handle(Occurred(EventKind.LOW_BATTERY), 1.0)
    executor.handle(ActionStopped("MEASURE 1"), 2.0)
    assert executor.running is not None
    assert executor.running.name == "react to low_battery"
    executor.handle(Occurred(EventKind.EMERGENCY_STOP), 3.0)
    executor.handle(ActionStopped("react to low_battery"), 4.0)
    assert executor.outcome is Outcome.ABORTED


@pytest.mark.rule("G6", "G14")
@pytest.mark.parametrize(
    ("lines", "ends", "ways"),
    [
        (
            "1. Check #1; if it is above 5, go to step 1; otherwise go to step 3.\n"
            "2. Repeat step 1 twice.\n3. Check #3",
            "end of 'Repeat 1'",
            {"MEASURE 1": ["MEASURE 1", "MEASURE 3"], "end of 'Repeat 1'": ["MEASURE 3"]},
        ),
        (
            "1. Check #1; if it is above 5, go on. Then go to step 4.\n"
            "2. Repeat step 1 twice.\n3. Check #3.\n4. Check #4",
            "end of 'Repeat 1'",
            {"MEASURE 1": ["end of 'Repeat 1'"] * 2, "end of 'Repeat 1'": ["MEASURE 4"]},
        ),
        (
            "1. Check #1; then go to step 4.\n2. Repeat step 1 twice; if #1 is above 5, check #2.\n"
            "3. Check #3.\n4. Check #4",
            "MEASURE 1",
            {
                "MEASURE 1": ["after 'Repeat 1'"],
                "after 'Repeat 1'": ["MEASURE 2", "MEASURE 4"],
                "MEASURE 2": ["MEASURE 3"],
            },
        ),
        (
            '1. "a": check #1; if it is above 5, check #2.\n2. Repeat step "a" twice.\n3. Check #3',
            "end of 'Repeat a'",
            {
                "a": ["MEASURE 2", "end of 'Repeat a'"],
                "MEASURE 2": ["end of 'Repeat a'"],
                "end of 'Repeat a'": ["MEASURE 3"],
            },
        ),
    ],
)
def test_where_a_round_ends_and_what_comes_then(
    lines: str, ends: str, ways: dict[str, list[str]], catalog: Catalog
) -> None:
    mission = read(lines, catalog)
    assert mission.groups[0].end == ends
    found = {t.name: [way.target for way in t.transitions] for t in mission.tasks}
    assert {name: found[name] for name in ways} == ways
