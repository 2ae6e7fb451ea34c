"""Claims that something is impossible have a witness, and the checker accepts no wrong one."""

import json
from dataclasses import asdict, replace

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import Verdict, analyse, unproved
from argo_compiler.analysis.verification import Verifier
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.il import Action, ConditionType, Group, Mission, OnFailure, Task
from tests.argo_compiler.analysis.building import CATALOG, mission, task, transition
from tests.argo_compiler.analysis.worlds import conditions
from tests.argo_compiler.hfsm.random_missions import missions
from tests.conftest import examples
from tests.mission_parts import HERE, groups_over, transitions

SLOW = [HealthCheck.filter_too_much, HealthCheck.too_slow]
PLACES = ("tasks", "rounds", "cuts")


@settings(max_examples=examples(25), suppress_health_check=SLOW)
@given(missions())
def test_all_claims_about_missions_of_the_whole_language_are_proved(plan):
    assume(not has_errors(check(plan)))
    analysis = analyse(plan)
    assert analysis.witnesses is not None
    assert unproved(plan, None, analysis) == ()
    assert not any("happen" in words for words in analysis.unjudged)
    json.dumps(asdict(analysis.witnesses))


# A brute-force explorer of missions in which nothing depends on time.


@st.composite
def plain_tasks(draw, name, names, index, object_id):
    objects = ("1", "2") if object_id is None else (object_id, "1", "2")
    ageless = conditions(objects).map(lambda c: c.model_copy(update={"max_age": None}))
    policy = draw(st.sampled_from([OnFailure.CONTINUE, OnFailure.BRANCH, OnFailure.ABORT]))
    return Task(
        name=name,
        action=Action.WAYPOINT if object_id is None else Action.MEASURE,
        object_id=object_id,
        pose=HERE if object_id is None else None,
        on_failure=policy,
        failure_target=draw(st.sampled_from(names)) if policy is OnFailure.BRANCH else None,
        transitions=draw(transitions(names, index, lambda: ageless)),
    )


@st.composite
def timeless_missions(draw):
    size = draw(st.integers(1, 6))
    objects = [draw(st.sampled_from([None, "1", "2"])) for _ in range(size)]
    names = [f"T{i}" for i in range(size)]
    groups = tuple(
        group.model_copy(update={"max_repeat_duration": 0.0, "every": 0.0})
        for group in draw(groups_over(names, interruptions=False))
    )
    tasks = tuple(draw(plain_tasks(n, names, i, objects[i])) for i, n in enumerate(names))
    return Mission(tasks=tasks, groups=groups)


VALUES = [v / 2 for v in range(-3, 17)]


def holds(condition, readings):
    value = readings.get(condition.object_id)
    if not isinstance(value, float):
        return False
    low, high, equal = condition.param1, condition.param2, condition.inclusive
    if condition.type is ConditionType.LESS:
        return value < low or (equal and value == low)
    if condition.type is ConditionType.GREATER:
        return value > low or (equal and value == low)
    return low < value < high or (equal and value in (low, high))


class Explorer:
    """Everything that can happen in a mission, found by trying all values of two checkpoints."""

    def __init__(self, plan, failures):
        self.plan = plan
        self.failures = failures
        self.position = {one.name: i for i, one in enumerate(plan.tasks)}
        self.ending = {}
        for group in sorted(plan.groups, key=lambda g: -g.name.count("/")):
            self.ending.setdefault(group.end, []).append(group)
        self.tasks, self.transitions, self.ended, self.seen = set(), set(), False, set()
        pending = [(plan.tasks[0].name, ())]
        while pending:
            here = pending.pop()
            if here in self.seen or len(self.seen) > 4000:
                continue
            self.seen.add(here)
            pending += self.after(*here)

    def after(self, name, known):
        current = self.plan.tasks[self.position[name]]
        self.tasks.add(self.position[name])
        for reading in self.outcomes(current):
            readings = dict(known)
            if current.object_id is not None:
                readings[current.object_id] = reading
            frozen = tuple(sorted(readings.items(), key=str))
            lost = reading in ("failed", "lost")
            if lost and current.on_failure is OnFailure.BRANCH:
                yield current.failure_target, frozen
            elif lost and current.on_failure is OnFailure.ABORT:
                self.ended = True
            else:
                yield from ((target, frozen) for target in self.targets(current, readings))

    def outcomes(self, current):
        if current.action is Action.MEASURE:
            yield from VALUES
        else:
            yield "done"
        if self.failures:
            yield "failed"

    def targets(self, current, readings):
        at = self.position[current.name]
        for k, candidate in enumerate(current.transitions):
            if candidate.conditions and all(holds(c, readings) for c in candidate.conditions):
                self.transitions.add((at, k))
                return [candidate.target]
        found = []
        for group in self.ending.get(current.name, []):
            if group.max_repeat_count != 1:
                found.append(group.start)
            if not group.max_repeat_count:
                return found
        last = next((k for k, t in enumerate(current.transitions) if not t.conditions), None)
        if last is None:
            self.ended = True
            return found
        self.transitions.add((at, last))
        return [*found, current.transitions[last].target]


@settings(max_examples=examples(20), suppress_health_check=SLOW)
@given(timeless_missions())
def test_what_can_be_found_by_trying_everything_is_not_called_impossible(plan):
    assume(not has_errors(check(plan)))
    analysis = analyse(plan)
    for failures in (False, True):
        found = Explorer(plan, failures)
        excluded = {Verdict.NEVER} if failures else {Verdict.NEVER, Verdict.AFTER_FAILURE}
        for facts in analysis.tasks:
            at = found.position[facts.task]
            assert not (at in found.tasks and facts.verdict in excluded)
            for one in facts.transitions:
                assert not ((at, one.index) in found.transitions and one.verdict in excluded)
        assert not (found.ended and analysis.ends in excluded)


@settings(max_examples=examples(25), suppress_health_check=SLOW)
@given(timeless_missions(), st.data())
def test_a_witness_that_leaves_out_what_happens_is_not_taken(plan, data):
    assume(not has_errors(check(plan)))
    analysis = analyse(plan)
    failures = data.draw(st.booleans())
    witness = analysis.witnesses.all if failures else analysis.witnesses.nominal
    corrupted = data.draw(corruptions(witness))
    proved = Verifier(plan, None).check_invariant(corrupted)
    if proved is None:
        return
    found = Explorer(plan, failures)
    assert found.tasks <= proved.tasks
    assert found.transitions <= proved.transitions
    assert proved.ended or not found.ended
    for name, known in found.seen:
        state = corrupted.tasks[found.position[name]]
        for scale in corrupted.scales:
            assert state >> scale.shift & bit_of(scale, dict(known).get(scale.object_id))


def bit_of(scale, reading):
    """Return the bit of a reading, computed independently by counting the bounds below a value."""
    n = len(scale.bounds)
    if not isinstance(reading, float):
        return 1 << (2 * n + (1 if reading is None else 3))
    below = sum(bound < reading for bound in scale.bounds)
    return 1 << (2 * below + (reading in scale.bounds))


@st.composite
def corruptions(draw, witness):
    """Draw the witness with something removed: a task, a group, readings, a scale or the end."""
    column = draw(st.sampled_from([*PLACES[:2], "tasks", "ended", "scales"]))
    if column == "ended":
        return replace(witness, ended=False)
    if column == "scales":
        return replace(witness, scales=witness.scales[1:])
    states = list(getattr(witness, column))
    reached = [i for i, state in enumerate(states) if state is not None]
    assume(reached)
    at = draw(st.sampled_from(reached))
    bits = [k for k in range(states[at].bit_length()) if states[at] >> k & 1]
    if not bits or draw(st.booleans()):
        states[at] = None
    else:
        states[at] &= ~(1 << draw(st.sampled_from(bits)))
    return replace(witness, **{column: tuple(states)})


PLAN = mission(
    task("Am1", transition("C", "1 > 12"), "B"),
    task("B", transition("D", "1 < 5"), transition("E", "1 >= 5"), "C"),
    task("C", "D"),
    task("D"),
    task("E", "D"),
)


def test_a_claim_that_is_made_up_is_named():
    analysis = analyse(PLAN, CATALOG)
    assert unproved(PLAN, CATALOG, analysis) == ()
    assert analysis.task_facts("C").verdict is Verdict.AFTER_FAILURE
    for k, facts in enumerate(analysis.tasks):
        claimed = Verdict.AFTER_FAILURE if facts.task == "C" else Verdict.POSSIBLE
        assert facts.verdict is claimed
        tasks = list(analysis.tasks)
        tasks[k] = facts.model_copy(update={"verdict": Verdict.NEVER})
        wrong = analysis.model_copy(update={"tasks": tuple(tasks)})
        assert unproved(PLAN, CATALOG, wrong) == (f"task '{facts.task}'",)
    wrong = analysis.model_copy(update={"ends": Verdict.NEVER})
    assert unproved(PLAN, CATALOG, wrong) == ("how the mission ends",)


def test_what_is_claimed_with_a_catalogue_is_not_proved_without_it():
    assert unproved(PLAN, None, analyse(PLAN, CATALOG)) == ("what can't happen",)


@pytest.mark.rule("C8")
def test_a_claim_that_a_value_reported_by_others_disproves_is_not_proved():
    plan = mission("A", task("B", transition("D", "1 > 5"), "C"), task("C"), task("D"))
    analysis = analyse(plan, CATALOG)
    assert unproved(plan, CATALOG, analysis) == ()
    for witness in (analysis.witnesses.nominal, analysis.witnesses.all):
        (scale,) = witness.scales
        unmeasured = 1 << (2 * len(scale.bounds) + 1 + scale.shift)
        tasks = tuple(None if t is None else unmeasured for t in witness.tasks)
        assert Verifier(plan, CATALOG).check_invariant(replace(witness, tasks=tasks)) is None


def kept_loops(plan):
    return [d for d in analyse(plan, CATALOG).diagnostics if d.code == "analysis.kept-loop"]


def test_a_loop_that_a_reading_keeps_is_found_with_the_readings():
    plan = mission(task("Am1", "B"), task("B", transition("B", "1 > 5"), "C"), task("C"))
    (found,) = kept_loops(plan)
    assert found.subject == "tasks['B']"
    assert "task 'B' follows itself for ever" in found.message
    assert "checkpoint 1 (valve R1) shows 5 to 10 (without 5)" in found.message


def test_a_loop_of_several_tasks_that_may_lack_a_value_is_found():
    plan = mission(
        task("Am2", transition("Fm1", "2 > 5"), "B"),
        task("Fm1", "B"),
        task("B", transition("E", "1 > 5"), "D"),
        task("D", "B"),
        task("E"),
    )
    (found,) = kept_loops(plan)
    assert "tasks 'B' and 'D' follow each other for ever" in found.message
    assert "shows 0 to 5 or has no value when 'B' is reached" in found.message


@pytest.mark.parametrize(
    "plan",
    [
        # measured again
        mission(task("Am1", "B"), task("B", transition("Am1", "1 > 5"), "C"), task("C")),
        # a value grows too old
        mission(task("Am1", "B"), task("B", transition("B", "1 > 5", max_age=60), "C"), task("C")),
        # time ends it
        mission(
            task("Am1", "B"),
            task("B", transition("B", "1 > 5"), "C"),
            task("C"),
            groups=[Group(name="g", start="B", end="B", max_repeat_duration=60)],
        ),
        # no value keeps it
        mission(task("Am1", "B"), task("B", transition("B", "1 > 12"), "C"), task("C")),
    ],
)
def test_a_loop_that_may_end_is_not_called_endless(plan):
    assert kept_loops(plan) == []


def test_a_corrupted_loop_is_rejected():
    plan = mission(
        task("Am1", "B"), task("B", transition("D", "1 > 5"), "C"), task("D", "B"), task("C")
    )
    witnesses = analyse(plan, CATALOG).witnesses
    (trap,) = witnesses.traps
    verifier = Verifier(plan, CATALOG)
    assert verifier.check_trap(trap, witnesses.nominal)
    wrong = [
        replace(trap, tasks=("B",)),
        replace(trap, tasks=("D",)),
        replace(trap, tasks=()),
        replace(trap, tasks=("B", "unknown")),
        replace(trap, kept=None),
        *(
            replace(trap, kept=replace(trap.kept, readings=trap.kept.readings | 1 << k))
            for k in range(2 * len(trap.kept.bounds) + 4)
            if not trap.kept.readings >> k & 1 and k != 6
        ),
        replace(trap, kept=replace(trap.kept, readings=0)),
        replace(trap, kept=replace(trap.kept, bounds=())),
        replace(trap, kept=replace(trap.kept, object_id="2")),
    ]
    for one in wrong:
        assert not verifier.check_trap(one, witnesses.nominal), one
