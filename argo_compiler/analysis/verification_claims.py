"""The claims of an analysis beside what its witnesses prove."""

from argo_compiler.analysis.facts import (
    Analysis,
    GroupFacts,
    TaskFacts,
    TransitionFacts,
    Verdict,
)
from argo_compiler.analysis.verification import Verifier
from argo_compiler.analysis.verification_walk import Proved
from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission


def unproved(mission: Mission, catalog: Catalog | None, analysis: Analysis) -> tuple[str, ...]:
    """The claims of an analysis that its witnesses do not show, in words; none: all are right."""
    witnesses = analysis.witnesses
    if witnesses is None:
        return ("there are no witnesses",)
    verifier = Verifier(mission, catalog)
    nominal, whatever = verifier.invariant(witnesses.nominal), verifier.invariant(witnesses.all)
    if nominal is None or whatever is None or not witnesses.all.failures:
        return ("what can't happen",)
    if witnesses.nominal.failures:
        return ("what happens only after failures",)
    claims = _Claims(mission, nominal, whatever)
    wrong = [claims.of_task(facts) for facts in analysis.tasks]
    wrong += [claims.of_group(facts) for facts in analysis.groups]
    if not _excluded(analysis.ends, whatever.ended, nominal.ended):
        wrong.append(["how the mission ends"])
    traps = ["endless loops" for t in witnesses.traps if not verifier.trap(t, witnesses.nominal)]
    return tuple(dict.fromkeys([*(one for many in wrong for one in many), *traps]))


def _excluded(verdict: Verdict, whatever: bool, nominal: bool) -> bool:
    """Whether what a verdict excludes is excluded, by what may be with failures and without."""
    if verdict is Verdict.NEVER:
        return not whatever
    return not (verdict is Verdict.AFTER_FAILURE and nominal)


class _Claims:
    """The verdicts of an analysis beside what is proved."""

    def __init__(self, mission: Mission, nominal: Proved, whatever: Proved) -> None:
        self.mission = mission
        self.tasks = {task.name: i for i, task in enumerate(mission.tasks)}
        self.groups = {group.name: i for i, group in enumerate(mission.groups)}
        self.nominal = nominal
        self.whatever = whatever

    def of_task(self, facts: TaskFacts) -> list[str]:
        at = self.tasks.get(facts.task)
        if at is None:
            return [f"task '{facts.task}'"]
        right = _excluded(facts.verdict, at in self.whatever.tasks, at in self.nominal.tasks)
        wrong = [] if right else [f"task '{facts.task}'"]
        for one in facts.transitions:
            if not self._right(at, one):
                wrong.append(f"transition {one.index} of task '{facts.task}'")
        return wrong

    def _right(self, at: int, facts: TransitionFacts) -> bool:
        key = (at, facts.index)
        if facts.verdict is not Verdict.ALWAYS:
            may = key in self.whatever.transitions, key in self.nominal.transitions
            return _excluded(facts.verdict, *may)
        transitions = self.mission.tasks[at].transitions
        if transitions[facts.index].conditions:
            return key in self.nominal.certain or key not in self.nominal.transitions
        return not any(
            transition.conditions and (at, k) in self.nominal.transitions
            for k, transition in enumerate(transitions)
        )

    def of_group(self, facts: GroupFacts) -> list[str]:
        at = self.groups.get(facts.group)
        if at is None:
            return [f"group '{facts.group}'"]
        whatever, nominal = self.whatever, self.nominal
        right = _excluded(facts.repeats, at in whatever.repeats, at in nominal.repeats)
        right = right and _excluded(facts.ends, at in whatever.ends, at in nominal.ends)
        return [] if right else [f"group '{facts.group}'"]
