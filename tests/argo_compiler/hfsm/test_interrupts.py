"""Table of interruptions, checked in all states that can be reached.

For each set of reactions, every trigger is tried in every state that can be reached, so that
sequences of any length are covered. The expected properties come from the rules, and each step is
compared with `interrupt_rules`, which has no table.
"""

from itertools import product

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import (
    ActionStopped,
    ActionSucceeded,
    Cause,
    Executor,
    GiveBack,
    Occurred,
    Outcome,
    Pause,
    Progress,
    Resume,
    Tick,
    lower,
)
from argo_compiler.hfsm.interrupt_state import InterruptState, rows_taken_at
from argo_compiler.hfsm.interrupts import ROWS, TABLE, InterruptGuard, Stage, Trigger
from argo_compiler.hfsm.progress import Waiting
from argo_compiler.il import Afterwards, EventKind, Mission, Reaction, Response, Task
from tests.argo_compiler.hfsm.interrupt_rules import Alarmed, Rules
from tests.conftest import sample

EVENTS = (EventKind.GAS_LEAK, EventKind.LOW_BATTERY, EventKind.EMERGENCY_STOP)
CLEAR = EventKind.ALL_CLEAR
HERE = Pose(x=0, y=0, z=0)
SUPERVISED = InterruptState(Stage.STOPPED, paused=True)

ACTIVE = (Stage.BEGINNING, Stage.DRIVING, Stage.ARRIVED, Stage.HOLDING, Stage.LETTING_GO)
"""stages that have an active reaction"""
TRANSIENT = (Stage.CHOOSING, Stage.BEGINNING, Stage.ARRIVED, Stage.LETTING_GO)
"""stages that take no time"""
STABLE = tuple(stage for stage in Stage if stage not in TRANSIENT)
EVENT_GUARDS = {
    InterruptGuard.ABORTS,
    InterruptGuard.REACTS,
    InterruptGuard.NEW,
    InterruptGuard.HIGHER,
    InterruptGuard.AWAITED,
}


def variants(
    event,
    untils,
    responses=tuple(Response),
    afterwards=tuple(Afterwards),
    limits=(None, *Afterwards),
):
    """Return the reactions to an event, apart from their priority."""
    all_fields = [{"response": r} for r in (Response.REPORT, Response.ABORT) if r in responses]
    for response in (r for r in responses if r not in (Response.REPORT, Response.ABORT)):
        pauses = response is Response.PAUSE
        for until, after, limit in product(untils, afterwards, limits):
            held = pauses or until is not None
            if (pauses and after is not afterwards[0]) or (limit is not None and not held):
                continue
            limited = {} if limit is None else {"hold_limit": 10, "on_limit": limit}
            pose = HERE if response is Response.SAFE_AREA else None
            fields = {"response": response, "until": until, "pose": pose, **limited}
            all_fields.append(fields | ({} if pauses else {"afterwards": after}))
    return [{"event": event, **fields} for fields in all_fields]


def reaction_sets(size, untils, priorities, **kinds):
    """Yield all sets of `size` reactions."""
    events = EVENTS[:size]
    for fields in product(*(variants(event, untils, **kinds) for event in events)):
        for given in product(priorities, repeat=size):
            if min(given) != priorities[0]:
                continue  # the same order as a set with lower ones
            yield tuple(
                Reaction(**one, priority=priority)
                for one, priority in zip(fields, given, strict=True)
            )


def all_triggers(reactions):
    kinds = {CLEAR, *(reaction.event for reaction in reactions)}
    kinds |= {reaction.until for reaction in reactions if reaction.until}
    yield from ((Trigger.EVENT, kind) for kind in sorted(kinds))
    yield from ((t, None) for t in Trigger if t not in (Trigger.ALWAYS, Trigger.EVENT))


def by_rules(rules, state, trigger, event):
    match trigger:
        case Trigger.EVENT:
            return rules.occurs(state, event)
        case Trigger.DONE:
            return rules.plan_ends(state, "completed", whenever=False)
        case Trigger.ENDED:
            return rules.plan_ends(state, "returned", whenever=True)
    return {
        Trigger.PAUSE: rules.pauses,
        Trigger.RESUME: rules.resumes,
        Trigger.CANCEL: rules.cancels,
        Trigger.DRIVEN: rules.drive_succeeds,
        Trigger.STUCK: rules.drive_fails,
        Trigger.LIMIT: rules.limit_is_over,
    }[trigger](state)


def as_alarmed(state):
    return Alarmed(
        paused=state.paused,
        alarms=tuple((pending.event, pending.until_occurred) for pending in state.pending),
        at=state.active,
        there=state.stage is Stage.HOLDING,
        outcome=state.outcome and str(state.outcome),
    )


def explore(reactions, taken):
    """Visit all states that can be reached.

    The rows that were taken are added to `taken`, with their stage. Returns the numbers of states
    and steps.
    """
    known = {reaction.event: reaction for reaction in reactions}
    rules = Rules(reactions)
    states = [InterruptState(), SUPERVISED]
    seen = set(states)
    everything = list(all_triggers(reactions))
    for before in states:
        for trigger, event in everything:
            plan = Outcome.COMPLETED if trigger is Trigger.DONE else Outcome.RETURNED
            rows = rows_taken_at(before, known, trigger, event, plan)
            taken.update((row.row, row.before.stage) for row in rows)
            after = rows[-1].after
            expected = by_rules(rules, as_alarmed(before), trigger, event)
            assert as_alarmed(after) == expected, (reactions, before, trigger, event)
            assert_invariants(known, before, trigger, event, rows)
            if after not in seen:
                seen.add(after)
                states.append(after)
    return len(states), len(states) * len(everything)


def assert_invariants(known, before, trigger, event, rows):
    """Assert properties that follow from the rules, whatever the table contains."""
    after = rows[-1].after
    own = known.get(event)
    live = before.outcome is None
    assert after.stage in STABLE
    assert (after.active is not None) == (after.stage in ACTIVE)
    assert (after.outcome is not None) == (after.stage is Stage.ENDING)
    if not live:
        assert after == before
        return
    if trigger is Trigger.CANCEL:
        assert after.outcome is Outcome.CANCELLED
    if own is not None and own.response is Response.ABORT:
        assert after.outcome is Outcome.ABORTED
    if after.outcome is not None:
        return
    # A person's pause lasts until a person ends it, and meanwhile nothing goes on.
    if before.paused and trigger is not Trigger.RESUME:
        assert after.paused
    if trigger is Trigger.PAUSE:
        assert after.paused
    assert not (after.paused and after.stage is Stage.GOING)
    # No reaction that waits is lost without having had its turn, and none that has to begin.
    pending = [one.event for one in after.pending]
    had_its_turn = {row.after.active for row in rows}
    assert {one.event for one in before.waiting} <= {*pending, *had_its_turn}
    assert len(pending) == len(set(pending))
    if own is not None and own.response is not Response.REPORT:
        active = known.get(before.active)
        ends_a_hold = active is not None and active.until is event
        if not (ends_a_hold and own.urgency_score <= active.urgency_score):
            assert event in {*pending, *had_its_turn, *(p.event for p in before.pending)}
    # Whoever has the robot ranks highest, unless a person has to let it go on.
    if not after.paused:
        ranks = [known[one.event].urgency_score for one in after.waiting]
        if after.active is None:
            assert not ranks
        else:
            assert all(rank <= known[after.active].urgency_score for rank in ranks)
            equal = [
                e for e in pending if known[e].urgency_score == known[after.active].urgency_score
            ]
            assert equal[0] is after.active
    # A hold ends by its event, a person, its limit, or one of higher rank.
    left = before.stage is Stage.HOLDING and after.active is not before.active
    if left:
        hold = known[before.active]
        awaited = trigger is Trigger.EVENT and hold.until is event and not before.paused
        higher = own is not None and own.urgency_score > hold.urgency_score
        assert awaited or higher or trigger in (Trigger.RESUME, Trigger.LIMIT)


def explore_all(many):
    """Explore sets of reactions; return the rows taken, and the numbers of sets, states, steps."""
    taken, count, states, steps = set(), 0, 0, 0
    for reactions in many:
        here, tried = explore(reactions, taken)
        count, states, steps = count + 1, states + here, steps + tried
    return taken, (count, states, steps)


# A safe area differs from the dock in the outcome only, which one reaction alone shows.
PAIRED = (Response.REPORT, Response.ABORT, Response.PAUSE, Response.RETURN)
PLAIN = {"afterwards": (Afterwards.RESUME,), "limits": (None,)}


@pytest.mark.rule("R1", "R2", "R3", "R4", "R6", "R7", "R8", "R9", "R10", "I1", "I2", "M9")
def test_one_reaction_alone_and_two_that_interrupt_each_other():
    one, _ = explore_all(reaction_sets(1, (None, CLEAR), (1,)))
    two, _ = explore_all(
        reaction_sets(2, (CLEAR, EVENTS[1]), (1, 2), responses=PAIRED[1:], **PLAIN)
    )
    assert {(row, stage) for row in TABLE for stage in row.stages} == one | two


@pytest.mark.long
@pytest.mark.rule("R7", "R9", "R10")
def test_pairs():
    _, tried = explore_all(
        sample(reaction_sets(2, (None, CLEAR, EVENTS[1]), (1, 2), responses=PAIRED))
    )
    print("sets, states, steps:", *tried)


@pytest.mark.long
@pytest.mark.rule("R7", "R9", "R10")
def test_three_reactions():
    three = reaction_sets(3, (CLEAR, EVENTS[0]), (1, 2), responses=PAIRED[1:], **PLAIN)
    _, tried = explore_all(sample(three))
    print("sets, states, steps:", *tried)


def test_each_stage_has_a_row_for_whatever_happens():
    for stage in STABLE:
        for trigger in set(Trigger) - {Trigger.ALWAYS}:
            last = ROWS[stage, trigger][-1]
            assert not last.when, (stage, trigger)
            assert not last.unless, (stage, trigger)
    for stage in TRANSIENT:
        last = ROWS[stage, Trigger.ALWAYS][-1]
        assert not last.when
        assert not last.unless


def test_rows_ask_only_for_what_is_there():
    """Guards refer to an event only in rows of EVENT, to an active reaction only where one is."""
    active_guards = (
        set(InterruptGuard) - EVENT_GUARDS - {InterruptGuard.PAUSED, InterruptGuard.SOME_WAITS}
    )
    active_guards |= {InterruptGuard.HIGHER, InterruptGuard.AWAITED}
    for row in TABLE:
        guards = {*row.when, *row.unless}
        assert row.trigger is Trigger.EVENT or not guards & EVENT_GUARDS
        assert not guards & active_guards or set(row.stages) <= set(ACTIVE)


class TestExecutor:
    """Limits and supervision of the table, as seen by a driver."""

    def run(self, mission):
        executor = Executor(lower(mission))
        self.at = lambda now, *events: [executor.handle(event, now) for event in events]
        executor.start(0)
        return executor

    def holding(self, **fields):
        hold = Reaction(event=EVENTS[0], until=CLEAR, hold_limit=10, **fields)
        executor = self.run(Mission(tasks=(TASK,), dock=HERE, reactions=(hold,)))
        self.at(1, Occurred(EVENTS[0]), ActionStopped("A"))
        return executor

    @pytest.mark.rule("R3")
    def test_hold_ends_when_its_limit_is_over(self):
        executor = self.holding(response="pause", on_limit="resume")
        assert executor.next_deadline == 11
        self.at(12, Tick())
        assert (executor.holding, executor.running) == (False, TASK)
        ends = [entry.time for entry in executor.trace if entry.cause is Cause.LIMIT]
        assert ends == [11]

    @pytest.mark.rule("R3")
    def test_person_is_waited_for_when_the_limit_is_over(self):
        executor = self.holding(response="pause", on_limit="wait")
        self.at(11, Tick())
        assert (executor.paused, executor.reaction) == (True, None)
        self.at(20, Resume())
        assert executor.running == TASK

    @pytest.mark.rule("R3")
    @pytest.mark.parametrize(
        ("response", "outcome"),
        [("pause", "aborted"), ("return", "returned"), ("safe_area", "sheltered")],
    )
    def test_mission_ends_when_the_limit_is_over(self, response, outcome):
        pose = HERE if response == "safe_area" else None
        fields = {"afterwards": "resume", "on_limit": "end", "pose": pose}
        executor = self.holding(response=response, **fields)
        if response != "pause":
            self.at(3, ActionSucceeded(executor.running.name))
        self.at(executor.next_deadline, Tick())
        assert executor.outcome == outcome
        assert executor.trace[-1].time == (11 if response == "pause" else 13)

    @pytest.mark.rule("R3", "I1")
    def test_limit_counts_pauses_and_takes_effect_after_them(self):
        executor = self.holding(response="pause", on_limit="end")
        self.at(5, Pause())
        assert executor.next_deadline is None
        self.at(30, Tick())
        assert executor.outcome is None
        self.at(31, Resume())
        assert (executor.outcome, executor.trace[-1].time) == (Outcome.ABORTED, 31)

    @pytest.mark.rule("R3", "R7")
    def test_hold_that_begins_anew_has_the_whole_limit(self):
        low = Reaction(event=EVENTS[0], response="pause", hold_limit=10, priority=1)
        high = Reaction(event=EVENTS[1], response="pause", until=CLEAR, priority=2)
        executor = self.run(Mission(tasks=(TASK,), reactions=(low, high)))
        self.at(1, Occurred(EVENTS[0]), ActionStopped("A"))
        self.at(8, Occurred(EVENTS[1]))
        self.at(9, Occurred(CLEAR))
        assert (executor.reaction, executor.next_deadline) == (EVENTS[0], 19)

    @pytest.mark.rule("M9")
    @pytest.mark.parametrize("begins", [Resume(), GiveBack()])
    def test_supervised_mission_begins_when_a_person_lets_it(self, begins):
        executor = self.run(Mission(tasks=(TASK,), mode="supervisory"))
        assert (executor.paused, executor.running) == (True, None)
        self.at(5, begins)
        assert executor.running == TASK

    @pytest.mark.rule("R7")
    def test_emergency_stop_ranks_above_priorities_and_abort_above_it(self):
        fields = {"response": "return", "until": CLEAR}
        reactions = (
            Reaction(event=EVENTS[0], priority=999, **fields),
            Reaction(event=EVENTS[2], priority=0, **fields),
            Reaction(event=EVENTS[1], response="abort", priority=0),
        )
        executor = self.run(Mission(tasks=(TASK,), dock=HERE, reactions=reactions))
        self.at(1, Occurred(EVENTS[0]), Occurred(EVENTS[2]))
        assert executor.reaction is EVENTS[2]
        self.at(2, Occurred(EVENTS[1]))
        assert executor.outcome is Outcome.ABORTED

    def test_progress_has_no_reaction_that_aborts(self):
        stop = Reaction(event=EVENTS[0], response="abort")
        machine = lower(Mission(tasks=(TASK,), reactions=(stop,)))
        waits = Progress(active="A", waiting=(Waiting(event=EVENTS[0]),))
        with pytest.raises(ArgoError, match="a reaction to gas_leak"):
            Executor.restore(machine, waits, 0)


TASK = Task(name="A", action="MEASURE", object_id="1")
