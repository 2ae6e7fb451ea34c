"""Results of the analysis of a mission, as data."""

from enum import StrEnum

from argo_compiler.analysis.witness import Witnesses
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic


class Verdict(StrEnum):
    """Verdict on whether something can happen on some execution path."""

    NEVER = "never"
    """on no path, whatever is measured and whatever fails"""
    AFTER_FAILURE = Message("after failure")
    """only after an action failed, a measurement gave no value, or a person did or skipped a
    task"""
    POSSIBLE = "possible"
    """not excluded by the analysis"""
    ALWAYS = "always"
    """whenever it is evaluated, unless a measurement fails or a person does or skips a task"""


class TransitionFacts(Model):
    """Verdict on one transition of a task; `index` counts from 0 in the task's list."""

    index: int
    target: str
    verdict: Verdict
    """NEVER also if the task itself can't be reached"""


class TaskFacts(Model):
    """Verdicts on one task and its transitions; an analysis has none for a START task."""

    task: str
    verdict: Verdict
    """whether the task can be reached: NEVER, AFTER_FAILURE or POSSIBLE"""
    transitions: tuple[TransitionFacts, ...] = ()


class GroupFacts(Model):
    """Verdicts on one group: whether it can start another round, and can end by itself."""

    group: str
    repeats: Verdict
    ends: Verdict


class Stretch(Model):
    """Part of an execution path: one task, or all rounds of a group."""

    task: str | None = None
    group: str | None = None
    rounds: int = 1
    missed: bool = False
    """whether the task's window closed before the task ended"""
    until: float
    """time (s) or energy (Wh) spent from the mission's start to the end of this part"""

    @property
    def task_or_rounds_text(self) -> str:
        if self.task is not None:
            return Message("{task} missed", task=self.task) if self.missed else self.task
        if self.rounds == 1:
            return Message("'{group}' x 1 round", group=self.group)
        return Message("'{group}' x {rounds} rounds", group=self.group, rounds=self.rounds)


class Bound(Model):
    """Bound on the duration or the energy, with a path that attains it if one is known."""

    value: float | None
    """s or Wh; None if there is no bound"""
    path: tuple[Stretch, ...] = ()


class Bounds(Model):
    """Least and greatest duration or energy of a mission from its start to its end.

    They hold if no action fails and no event occurs but those that a WAIT waits for. Reactions are
    left out, also the reaction to the end of `max_duration`.
    """

    least: Bound
    most: Bound


class Analysis(Model):
    """All results of an analysis; `diagnostics` are the messages for people."""

    diagnostics: tuple[Diagnostic, ...]
    tasks: tuple[TaskFacts, ...]
    groups: tuple[GroupFacts, ...]
    ends: Verdict
    """whether the mission can reach its end"""
    duration: Bounds | None = None
    """s; None without travel times, or if the mission can't end"""
    energy: Bounds | None = None
    """Wh"""
    duration_with_failures: Bound | None = None
    """upper bound in s, whatever fails and whatever events occur, reactions included, if no person
    interrupts; its `value` is None if there is no bound; None if it was not computed"""
    unjudged: tuple[str, ...] = ()
    """texts that name what was left out: the mission is too large or too deeply nested, or no
    witness proves a claim"""
    witnesses: Witnesses | None = None
    """evidence for the verdicts, which a checker can verify"""

    @property
    def reachable(self) -> frozenset[str]:
        """Names of all tasks that can be reached, also of those that only a failure leads to."""
        return frozenset(t.task for t in self.tasks if t.verdict is not Verdict.NEVER)

    def task_facts(self, name: str) -> TaskFacts:
        """Return the verdicts on a task.

        Raises:
            KeyError: There is no task of that name.
        """
        for facts in self.tasks:
            if facts.task == name:
                return facts
        raise KeyError(name)
