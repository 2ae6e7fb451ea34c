"""What the analysis finds out about a mission, as data."""

from enum import StrEnum

from argo_compiler.analysis.witness import Witnesses
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic


class Verdict(StrEnum):
    """Whether something may happen on some path."""

    NEVER = "never"
    """on no path, whatever is measured and whatever fails"""
    AFTER_FAILURE = "after failure"
    """only after an action has failed, a measurement gave no value, or a person did or skipped a
    task"""
    POSSIBLE = "possible"
    """nothing excludes it"""
    ALWAYS = "always"
    """whenever it is looked at, unless a measurement fails or a person does or skips a task"""


class TransitionFacts(Model):
    """A transition of a task. Indices count from 0 in the task's list."""

    index: int
    target: str
    verdict: Verdict
    """NEVER also where the task itself can't be reached"""


class TaskFacts(Model):
    """A task, START excepted."""

    task: str
    verdict: Verdict
    """NEVER, AFTER_FAILURE or POSSIBLE: whether it can be reached"""
    transitions: tuple[TransitionFacts, ...] = ()


class GroupFacts(Model):
    """A group: whether it may begin another round, and whether it may end by itself."""

    group: str
    repeats: Verdict
    ends: Verdict


class Stretch(Model):
    """A part of a path: one task, or all rounds of a group."""

    task: str | None = None
    group: str | None = None
    rounds: int = 1
    missed: bool = False
    """whether the task's window was over before it had ended"""
    until: float
    """when it has ended, counted from the mission's start (s, or Wh)"""

    @property
    def words(self) -> str:
        if self.task is not None:
            return f"{self.task} missed" if self.missed else self.task
        return f"'{self.group}' x {self.rounds} round{'s' if self.rounds != 1 else ''}"


class Bound(Model):
    """A bound, and a path that comes to it where one could be given."""

    value: float | None
    """s or Wh; None: there is no bound"""
    path: tuple[Stretch, ...] = ()


class Bounds(Model):
    """What the mission takes from its start to its end if no action fails and nothing happens, be
    it that its time is up: as if there was no reaction to that."""

    least: Bound
    most: Bound


class Analysis(Model):
    """All that was found. `diagnostics` says in words what a person should know."""

    diagnostics: tuple[Diagnostic, ...]
    tasks: tuple[TaskFacts, ...]
    groups: tuple[GroupFacts, ...]
    ends: Verdict
    """whether the mission can come to its end"""
    duration: Bounds | None = None
    """s; None without travel times, or where the mission can't end"""
    energy: Bounds | None = None
    """Wh"""
    duration_with_failures: Bound | None = None
    """s at most whatever fails and occurs, reactions included, if no person interrupts; a `value`
    of None: there is no bound. None: it was not looked at"""
    unjudged: tuple[str, ...] = ()
    """what was left out because the mission is too large or too deeply nested, in words"""
    witnesses: Witnesses | None = None
    """what shows that the verdicts are right"""

    @property
    def reachable(self) -> frozenset[str]:
        """The names of all tasks that may be reached."""
        return frozenset(t.task for t in self.tasks if t.verdict is not Verdict.NEVER)

    def task(self, name: str) -> TaskFacts:
        """The facts of a task; KeyError if there is none of that name."""
        for facts in self.tasks:
            if facts.task == name:
                return facts
        raise KeyError(name)
