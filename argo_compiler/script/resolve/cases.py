"""What is done if something is so: after a value, after a failure, after an event."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import NoReturn

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.listing import listed
from argo_compiler.il import Action, OnFailure
from argo_compiler.il.exclusive_conditions import are_surely_exclusive
from argo_compiler.script.documents.source import RefusedError
from argo_compiler.script.resolve.accepting import require_used
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.program import (
    Ahead,
    Choice,
    Do,
    HomeAhead,
    Leave,
    ProgramBlock,
    ProgramNode,
    Target,
    Way,
    in_branch,
    leads_away,
)
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.conditions import (
    InState,
    SaidCondition,
    TaskState,
    Test,
    TooLate,
)
from argo_compiler.script.sentences.tree.nouns import Kind, Pronoun, TheOne
from argo_compiler.script.sentences.tree.orders import Case, PlainWord, Rest, ScriptOrder
from argo_compiler.script.sentences.tree.places import DockLocation

_ENDINGS = {
    PlainWord.ABORT: Ahead.END,
    PlainWord.END: Ahead.END,
    PlainWord.GO_ON: Ahead.GO_ON,
}
_POLICIES = {
    PlainWord.ABORT: OnFailure.ABORT,
    PlainWord.END: OnFailure.ABORT,
    PlainWord.GO_ON: OnFailure.CONTINUE,
}
_EXCEPTIONS = (
    TaskState.FAILED,
    TaskState.UNREADABLE,
    TaskState.UNREACHABLE,
    TaskState.STALE,
)
"""states that can't be asked for turned round"""


@dataclass(frozen=True)
class _FailureRule:
    """Rule for the readings of a kind that fail: tries again, and a policy behind these, or None if
    the script asks for no more than the tries."""

    kind: Kind
    retries: tuple[orders.Retry, ...]
    policy: OnFailure | None


class Cases:
    """Plans cases behind what they are looked at after, and what is done in each. Raises
    RefusedError where that is not clear."""

    def __init__(
        self,
        context: Context,
        manners: Manners,
        carry_out: Callable[[Sequence[ScriptOrder], ProgramBlock], None],
    ) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.manners = manners
        self.carry_out = carry_out
        """plans orders as any others are planned"""
        self.told: list[Do] = []
        """the tasks of which it is said what is done if they fail"""
        self.asked: tuple[CheckpointInfo, ...] = ()
        """what `it` means in a condition, and where that does not hold"""
        self.general: list[_FailureRule] = []
        """what is done if any of several tasks fails"""

    def add(self, case: Case, block: ProgramBlock) -> None:
        """Plans one case; one that can't be is given up. After it, `it` may be what the condition
        asks of, or what is measured in that case only."""
        memory = self.context.memory
        before = memory.last
        if self.context.choice is not None and (case.condition is None or case.chained):
            memory.last = self.asked
        else:
            self.asked = before
        try:
            self._add(case, block)
        except RefusedError:
            self.context.fail()
        memory.last = (*before, *(c for c in memory.last if c not in before))

    def _add(self, case: Case, block: ProgramBlock) -> None:
        condition = case.condition
        case = replace(case, orders=tuple(self.context.skipping(o) for o in case.orders))
        if condition is None:
            chosen = case.rest is Rest.ALL_OTHERS and isinstance(self.context.choice, Choice)
            if case.rest is Rest.OTHERWISE or chosen:
                self._otherwise(case, block)
            else:
                self._rest(case, block)
            return
        condition = self._turned(self._as_failure_of_drive(condition))
        values = any(isinstance(test, Test) for test in condition.tests)
        late = any(isinstance(test, TooLate) for test in condition.tests)
        if values and not late and not case.orders:
            hint = "for example, add `go to step 5` or `return to the docking station`"
            self.diagnostics.refuse("unfinished", "this does not say what to do", case.span, hint)
        if condition.negated and (late or not values):
            message = "`unless` needs a condition on values, not an event or a missed time"
            hint = "write what to do if it happens: `if ..., go home`"
            self.diagnostics.refuse("condition", message, condition.span, hint)
        general = [t for t in condition.tests if isinstance(t, Test) and t.general]
        if any(test.is_of_failure for test in general):
            self._general(case, condition, general[0])
            return
        if late or not values or _is_failure(condition):
            self.context.choice = None
        if late:
            self._too_late(case, condition)
        elif not values:
            self.context.reactions.add(case)
        elif _is_failure(condition):
            self._failure(case, block)
            self.context.choice = self.context.recent[-1]
        else:
            self._values(case, condition, self._other_case(case, block) if case.chained else block)

    def _other_case(self, case: Case, block: ProgramBlock) -> ProgramBlock:
        """Where a condition of `otherwise, if ...` stands."""
        before = self.context.choice
        if isinstance(before, Choice) and before.is_listed and before.otherwise.first is None:
            return before.otherwise
        do = block.last
        if isinstance(before, Way) and isinstance(do, Do) and before in do.ways:
            if before.target is not Ahead.GO_ON:
                return block  # the first way whose condition holds is taken
            return self._to_choice(do, before, case, block).otherwise
        self._otherwise_of_what(case)

    # ---- values

    def _values(self, case: Case, condition: SaidCondition, block: ProgramBlock) -> None:
        alternatives = self.context.conditions.alternatives(condition)
        if condition is not case.condition and sum(map(len, alternatives)) != 1:
            message = "this condition can have one checkpoint only"
            hint = "write it the other way round: `if ..., go on; otherwise ...`"
            self.diagnostics.refuse("condition", message, condition.span, hint)
        do = block.last
        if isinstance(do, Leave):
            self.context.require_reached(case.span, block)
        if isinstance(do, Do) and any(way.otherwise for way in do.ways):
            message = "this is never evaluated: the `otherwise` before it leads elsewhere"
            hint = "write this condition before the `otherwise`"
            self.diagnostics.refuse("second-route", message, case.span, hint)
        target = None if condition.negated else self._target(case.orders)
        plain = isinstance(do, Do) and do.failure is None and do.missed is None
        if target is not None and isinstance(do, Do) and plain:
            way = Way(alternatives, target, case.span)
            do.ways.append(way)
            self.context.choice = way
            return
        choice = Choice(alternatives, case.span, negated=condition.negated, bound=self._bound(do))
        self.context.put([choice], block, do)
        if not in_branch(block):
            self.context.step.append(choice)
        self._plan(case.orders, choice.then)
        self.context.choice = choice

    def _bound(self, node: ProgramNode | None) -> bool:
        """Whether a node stands in the step that is being planned."""
        return node is not None and node in self.context.step[-1:]

    # ---- all others

    def _otherwise(self, case: Case, block: ProgramBlock) -> None:
        before = self.context.choice
        do = block.last
        if isinstance(before, Choice) and before.is_listed and before.block is not None:
            if before.otherwise.first is not None:
                message = "this condition has two `otherwise`"
                self.diagnostics.refuse("second-route", message, case.span, "remove one of them")
            # It is what is done if none of several conditions holds, where that is clear.
            if not _put_together(before):
                message = "`otherwise` can apply to the last of these conditions, or to all of them"
                hint = "write `otherwise, if ...`, or write each condition in a separate step"
                self.diagnostics.refuse("ambiguous-otherwise", message, case.span, hint)
            self._plan(case.orders, before.otherwise)
        elif isinstance(before, Way) and isinstance(do, Do):
            target = self._target(case.orders)
            if target is not None:
                do.ways.append(Way((), target, case.span, otherwise=True))
                return
            choice = self._to_choice(do, before, case, block)
            self._plan(case.orders, choice.otherwise)
            self.context.choice = choice
        elif not isinstance(before, Do) or not self._unless_failed(before, case, block):
            self._otherwise_of_what(case)

    def _otherwise_of_what(self, case: Case) -> NoReturn:
        message = "`otherwise` needs a condition before it"
        hint = "write it after the condition that it belongs to"
        self.context.refuse_missing("otherwise", message, case.span, hint)

    def _rest(self, case: Case, block: ProgramBlock) -> None:
        """The way that a task leads on if none of its conditions holds, wherever that is said."""
        do, target = block.last, self._target(case.orders)
        if not isinstance(do, Do) or target is None:
            message = f"`{case.rest}` must follow a task and lead to another one"
            hint = f"write it after the task: `{case.rest}, go to step 5`"
            self.diagnostics.refuse("otherwise", message, case.span, hint)
        last_round = case.rest is Rest.LAST_ROUND
        do.ways.append(Way((), target, case.span, last_round=last_round))

    def _to_choice(self, do: Do, way: Way, case: Case, block: ProgramBlock) -> Choice:
        """Puts a choice where a way was: its other case has orders of its own."""
        do.ways.remove(way)
        choice = Choice(way.alternatives, case.span, bound=self._bound(do))
        self.context.put([choice], block, do)
        self.context.step.append(choice)
        self.context.put([Leave(way.target, way.span)], choice.then, None)
        return choice

    # ---- what is done in a case

    def _plan(self, said: Sequence[ScriptOrder], branch: ProgramBlock) -> None:
        """Plans the orders of one case."""
        context = self.context
        before, ending = self._ending(list(said))
        memory = context.memory.last
        docked, recent, step = context.docked, context.recent, context.step
        context.docked, context.step = None, []
        self.carry_out(before, branch)
        if ending is not None:
            context.put([ending], branch, branch.last)
        if leads_away(branch.last):
            context.memory.last = memory
        context.docked, context.recent, context.step = docked, recent, step

    def _ending(self, said: list[ScriptOrder]) -> tuple[list[ScriptOrder], Leave | None]:
        """The orders of a case, and how it ends."""
        ending = None
        if said and isinstance(last := said[-1], orders.Plain) and last.word in _ENDINGS:
            require_used(last, self.context.diagnostics)
            ending = Leave(_ENDINGS[last.word], last.span)
            said.pop()
        if ending is not None and ending.target is Ahead.GO_ON:
            return said, ending
        if said and isinstance(home := said[-1], orders.Home):
            if home.manner or home.name is not None:
                return said, Leave(Ahead.END, home.span)
            said.pop()
            ending = Leave(self._home_ahead(home), home.span)
        return said, ending

    def _target(self, said: Sequence[ScriptOrder]) -> Target | None:
        """Return the target of a case whose only order is to go elsewhere; None for other cases."""
        if len(said) != 1 or said[0].manner or said[0].name is not None:
            return None
        match said[0]:
            case orders.Jump(step=step):
                return step
            case orders.Home() as home:
                return self._home_ahead(home)
            case orders.Plain(word=word):
                return _ENDINGS.get(word)
        return None

    def _home_ahead(self, order: orders.Home) -> HomeAhead:
        """The way home with which the mission ends where a condition leads to it."""
        named = order.dock.area
        area = None if named is None else self.context.lookup.area(named.area, order.dock.span)
        return HomeAhead(None if area is None else area.dock, order.dock.span)

    # ---- failures

    def _general(self, case: Case, condition: SaidCondition, test: Test) -> None:
        """Note what is done if any task fails: `if a reading fails, try it once more`."""
        retries = tuple(order for order in case.orders if isinstance(order, orders.Retry))
        rest = [order for order in case.orders if not (order in retries or _is_next(order))]
        policy = _policy(rest)
        failed = isinstance(test.predicate, InState) and test.predicate.state is TaskState.FAILED
        goes_on = policy is OnFailure.CONTINUE and not retries and test.is_of_failure
        plain = condition.tests == [test] and not (condition.negated or test.negated)
        if (rest and policy is None) or not plain or not (goes_on or failed):
            message = "this can be any of several checkpoints, or the last one"
            hint = "name the checkpoint: `if checkpoint 4 fails, ...`"
            self.diagnostics.refuse("ambiguous-pronoun", message, case.span, hint)
        nouns = () if test.subject is None else test.subject.nouns
        kind = next((n.kind for n in nouns if isinstance(n, TheOne)), Kind.CHECKPOINT)
        self.general.append(_FailureRule(kind, retries, policy))

    def finish(self) -> None:
        """Apply to each reading what is done if any fails, unless something is ordered for it."""
        for rule in self.general:
            readings = self.context.readings(rule.kind)
            for order in rule.retries:
                self.context.recent = [do for do in readings if not do.retries]
                if self.context.recent:
                    self.manners.amend(replace(order, again=False, every=False))
            if rule.policy is not None:
                open_ = [d for d in readings if not (d.failure or any(d is t for t in self.told))]
                self.told += open_
                self.context.recent = open_
                self.manners.on_failure(rule.policy)

    def _failure(self, case: Case, block: ProgramBlock) -> None:
        """Plan the orders that are carried out if the last task fails."""
        recent = self.context.recent
        if not recent:
            message = "there is no task before this to which a failure could apply"
            hint = "write it after the task that it applies to"
            self.diagnostics.refuse("no-task", message, case.span, hint)
        self._require_told(recent, case)
        self._require_each(recent, case)
        for order in case.orders:
            if isinstance(order, orders.Retry):
                self.carry_out([replace(order, again=False)], block)
        rest = [order for order in case.orders if not isinstance(order, orders.Retry)]
        if not rest:
            return
        if any(do.failure or any(do is one for one in self.told) for do in recent):
            message = "the script already says what to do if it fails"
            self.diagnostics.refuse("second-route", message, case.span, "remove one of the two")
        self.told += recent
        if (policy := _policy(rest)) is not None:
            self.manners.on_failure(policy)
            return
        if len(recent) > 1:
            message = "several tasks are meant here, and each would need separate commands"
            hint = "write one sentence for each of them"
            self.diagnostics.refuse("failure", message, case.span, hint)
        do = recent[-1]
        do.failure = ProgramBlock(do)
        self._plan(rest, do.failure)

    def _require_told(self, recent: Sequence[Do], case: Case) -> None:
        """Asks which task is meant, where one was to be measured in one case only."""
        numbers = {do.object_id for do in recent}
        last = self.context.memory.last
        others = [c for c in last if str(c.id) not in numbers]
        if not others or len(others) == len(last):
            return
        names = listed((f"{c.name} (#{c.id})" for c in last[:6]), "or")
        hint = "write it after the task that it applies to: `check checkpoint 4; if it fails, ...`"
        self.diagnostics.refuse("ambiguous-pronoun", f"this can apply to {names}", case.span, hint)

    def _require_each(self, recent: Sequence[Do], case: Case) -> None:
        """Asks about `if both fail`, as each task has a failure path of its own."""
        assert case.condition is not None
        nouns = [
            noun
            for test in case.condition.tests
            if isinstance(test, Test) and test.subject is not None
            for noun in test.subject.nouns
        ]
        all_ = any(isinstance(noun, Pronoun) and noun.every and not noun.either for noun in nouns)
        one = any(isinstance(noun, Pronoun) and noun.either for noun in nouns)
        if all_ or (one and len(recent) == 1):
            message = "this can apply to each of them, or to all together"
            hint = "write `if one of them fails, ...` after a list, or a sentence for each"
            self.diagnostics.refuse("failure", message, case.span, hint)

    def _unless_failed(self, do: Do, case: Case, block: ProgramBlock) -> bool:
        """Plans what is done if a task does not fail; False if a failure leads on to the same."""
        left = do.failure is not None and leads_away(do.failure.last)
        if block.last is not do or not (left or do.on_failure is not OnFailure.CONTINUE):
            return False
        self.carry_out(case.orders, block)
        return True

    def _turned(self, condition: SaidCondition) -> SaidCondition:
        """`If it does not fail` as `unless it fails`."""
        match condition.alternatives:
            case ((Test(predicate=InState(state=state)) as test,),) if state in _EXCEPTIONS:
                pass
            case _:
                return condition
        negated = condition.negated is not test.negated
        asked = replace(test, negated=False)
        found = replace(condition, alternatives=((asked,),), negated=negated)
        measured = {do.action for do in self.context.recent} <= {Action.MEASURE}
        if negated and not measured and state is TaskState.FAILED and _is_of_it(test):
            message = "`it` can be the last task, or the last measurement"
            hint = "name the checkpoint: `if checkpoint #1 has not failed, ...`"
            self.diagnostics.refuse("ambiguous-pronoun", message, test.span, hint)
        return found if test.negated else condition

    def _as_failure_of_drive(self, condition: SaidCondition) -> SaidCondition:
        """Return `if it is unreachable` after a drive as `if it fails`, which means the same."""
        drives = {do.action for do in self.context.recent} == {Action.WAYPOINT}
        match condition.alternatives:
            case ((Test(predicate=InState(state=TaskState.UNREACHABLE) as said_) as test,),) if (
                drives and _is_of_it(test)
            ):
                failed = replace(said_, state=TaskState.FAILED)
                return replace(condition, alternatives=((replace(test, predicate=failed),),))
        return condition

    def _too_late(self, case: Case, condition: SaidCondition) -> None:
        """Plan the orders that are carried out if the last task misses its window."""
        recent = self.context.recent
        alone = len(condition.alternatives) == len(condition.alternatives[0]) == 1
        if not alone or len(recent) != 1 or recent[0].window is None:
            message = "this must follow a task that has a latest time"
            hint = "write `Check checkpoint #1 not later than 10 minutes after the start. If it is "
            hint += "too late, go to step 5.`"
            self.diagnostics.refuse("too-late", message, case.span, hint)
        (do,) = recent
        if do.missed is not None:
            message = "the script already says what to do if it is too late"
            self.diagnostics.refuse("second-route", message, case.span, "remove one of the two")
        do.missed = ProgramBlock(do)
        self._plan(case.orders, do.missed)


def _policy(said: Sequence[ScriptOrder]) -> OnFailure | None:
    """Return the way that a mission has for failures, if that is all that is ordered, or None."""
    match said:
        case [order] if order.manner or order.name is not None:
            return None
        case [orders.Plain(word=word)]:
            return _POLICIES.get(word)
        case [orders.Home(dock=DockLocation(area=None))]:
            return OnFailure.RETURN
    return None


def _is_next(order: ScriptOrder) -> bool:
    """Return True for `carry on with the next point`."""
    return isinstance(order, orders.Jump) and order.step.ahead and order.step.points == (1,)


def _is_failure(condition: SaidCondition) -> bool:
    """Return whether a case asks only whether the last task has failed."""
    match condition.alternatives:
        case ((Test(predicate=InState(state=TaskState.FAILED), negated=False) as test,),):
            return _is_of_it(test) and not condition.negated
    return False


def _is_of_it(test: Test) -> bool:
    return test.subject is None or all(isinstance(n, Pronoun) for n in test.subject.nouns)


def _put_together(last: Choice) -> bool:
    """Puts the conditions that belong together so that the other case of the last one is what is
    done if none of them holds; False if it may be meant for the last of them only."""
    chain = [last]
    while isinstance(before := chain[-1].before, Choice) and chain[-1].bound:
        chain.append(before)
    chain.reverse()
    if isinstance(last.then.last, Choice):
        return False  # `if ..., check #2 unless ...; otherwise ...`
    several = [c for c in chain if c is last or not isinstance(c.then.last, Leave)]
    if len(several) == 1:
        return True
    clear = all(
        are_surely_exclusive(a.alternatives, b.alternatives) for a, b in combinations(several, 2)
    )
    if not clear or any(c.negated or c.otherwise.first is not None for c in chain):
        return False
    for outer, inner in pairwise(chain):
        inner.home.remove(inner)
        outer.otherwise.append(inner)
    return True
