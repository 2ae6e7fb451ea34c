"""Comparison of the claims of an analysis with what its witnesses prove."""

from argo_compiler.analysis.results import (
    Analysis,
    GroupFacts,
    TaskFacts,
    TransitionFacts,
    Verdict,
)
from argo_compiler.analysis.verification import Verifier
from argo_compiler.analysis.verification_walk import Proved
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.message import Message
from argo_compiler.il import Mission


def unproved(mission: Mission, catalog: Catalog | None, analysis: Analysis) -> tuple[str, ...]:
    """Return texts that name the claims of an analysis which its witnesses do not prove.

    There are none if all claims are proved. For claims of lower bounds, see `unproved_bounds`.
    """
    witnesses = analysis.witnesses
    if witnesses is None:
        return (Message("there are no witnesses"),)
    verifier = Verifier(mission, catalog)
    nominal, with_failures = (
        verifier.check_invariant(witnesses.nominal),
        verifier.check_invariant(witnesses.all),
    )
    if nominal is None or with_failures is None or not witnesses.all.failures:
        return (Message("what can't happen"),)
    if witnesses.nominal.failures:
        return (Message("what happens only after failures"),)
    claims = _Claims(mission, nominal, with_failures)
    wrong = [claims.wrong_in_task(facts) for facts in analysis.tasks]
    wrong += [claims.wrong_in_group(facts) for facts in analysis.groups]
    if not _is_proved(analysis.ends, with_failures.ended, nominal.ended):
        wrong.append([Message("how the mission ends")])
    traps = [
        Message("endless loops")
        for t in witnesses.traps
        if not verifier.check_trap(t, witnesses.nominal)
    ]
    return tuple(
        dict.fromkeys([*(claim for claims_of_one in wrong for claim in claims_of_one), *traps])
    )


def _is_proved(verdict: Verdict, with_failures: bool, nominal: bool) -> bool:
    """Return True if what a verdict excludes is proved impossible.

    `with_failures` and `nominal` are True if, by the proofs, the event that the verdict is about is
    possible with failures and without.
    """
    if verdict is Verdict.NEVER:
        return not with_failures
    return not (verdict is Verdict.AFTER_FAILURE and nominal)


class _Claims:
    """Check of an analysis's verdicts against what is proved with failures and without."""

    def __init__(self, mission: Mission, nominal: Proved, with_failures: Proved) -> None:
        self.mission = mission
        self.tasks = {task.name: i for i, task in enumerate(mission.tasks)}
        self.groups = {group.name: i for i, group in enumerate(mission.groups)}
        self.nominal = nominal
        self.with_failures = with_failures

    def wrong_in_task(self, facts: TaskFacts) -> list[str]:
        at = self.tasks.get(facts.task)
        if at is None:
            return [Message("task '{task}'", task=facts.task)]
        right = _is_proved(facts.verdict, at in self.with_failures.tasks, at in self.nominal.tasks)
        wrong: list[str] = [] if right else [Message("task '{task}'", task=facts.task)]
        for transition in facts.transitions:
            if not self._is_transition_proved(at, transition):
                wrong.append(
                    Message(
                        "transition {index} of task '{task}'",
                        index=transition.index,
                        task=facts.task,
                    )
                )
        return wrong

    def _is_transition_proved(self, at: int, facts: TransitionFacts) -> bool:
        key = (at, facts.index)
        if facts.verdict is not Verdict.ALWAYS:
            may = key in self.with_failures.transitions, key in self.nominal.transitions
            return _is_proved(facts.verdict, *may)
        transitions = self.mission.tasks[at].transitions
        if transitions[facts.index].conditions:
            return key in self.nominal.certain or key not in self.nominal.transitions
        return not any(
            transition.conditions and (at, k) in self.nominal.transitions
            for k, transition in enumerate(transitions)
        )

    def wrong_in_group(self, facts: GroupFacts) -> list[str]:
        at = self.groups.get(facts.group)
        if at is None:
            return [Message("group '{group}'", group=facts.group)]
        with_failures, nominal = self.with_failures, self.nominal
        right = _is_proved(facts.repeats, at in with_failures.repeats, at in nominal.repeats)
        right = right and _is_proved(facts.ends, at in with_failures.ends, at in nominal.ends)
        return [] if right else [Message("group '{group}'", group=facts.group)]
