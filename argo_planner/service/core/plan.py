"""A mission under edit: its revisions, and what each command makes of it."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime

from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.editing import Consequence, EditError
from argo_compiler.editing.commands import apply
from argo_compiler.editing.consequences import new_errors
from argo_compiler.il import Mission
from argo_planner.service.core.change import applied, difference
from argo_planner.service.core.commands import (
    EditPlan,
    PlanCommand,
    RedoEdit,
    ReplaceFrom,
    ReplacePlan,
    Revision,
    UndoEdit,
)
from argo_planner.service.core.plan_limits import require_fitting
from argo_planner.service.core.refusals import (
    ChangedSince,
    CommandIdTaken,
    EditRefused,
    NothingToUndo,
    StaleRevision,
)
from argo_planner.service.core.reverting import Subject, revert

HISTORY = 500
"""revisions that are kept, and can be undone"""

Stacks = Mapping[str, tuple[int, ...]]
"""revisions by author, the newest one last"""


@dataclass(frozen=True)
class MissionPlan:
    """A mission with its history. Each command makes another plan of it; this one stays."""

    mission: Mission
    revision: int = 1
    """of the mission; a new plan has 1"""
    history: tuple[Revision, ...] = ()
    """the last ones, up to the present one"""
    missions: tuple[Mission, ...] = ()
    """before the first one in the history, then after each of them but the last"""
    undoable: Stacks = field(default_factory=dict)
    redoable: Stacks = field(default_factory=dict)

    def since(self, revision: int) -> tuple[Revision, ...] | None:
        """The revisions after that one, in order; None if they are not known any more, or not
        yet."""
        count = self.revision - revision
        if not 0 <= count <= len(self.history):
            return None
        return self.history[len(self.history) - count :]

    def require_newest(self, made_on: int | None) -> None:
        """Raises StaleRevision if the plan has another revision by now; None: it may have any."""
        if made_on is not None and made_on != self.revision:
            raise StaleRevision(made_on, self.revision, self.since(made_on))

    def repeated(self, command: PlanCommand | ReplaceFrom, author: str) -> Revision | None:
        """What came of the command, if it has been carried out before.

        Raises CommandIdTaken if another one has had its id.
        """
        known = next((r for r in self.history if r.id == command.id), None)
        if known is not None and known.digest != digest_of(command, author):
            raise CommandIdTaken(
                f"another command has had the id {command.id}: give each command its own"
            )
        return known

    def carried_out(
        self,
        command: PlanCommand,
        author: str,
        made_on: int | None,
        at: datetime,
        asked: ReplaceFrom | None = None,
    ) -> "MissionPlan":
        """The plan after a command that an author has made on a revision; its last revision tells
        what changed. A command that has been carried out before is not carried out again; it is
        known by what was `asked`, where that stands for it.

        Raises:
            StaleRevision: the plan has another revision by now.
            EditRefused, ChangedSince, NothingToUndo, CommandIdTaken, DiagnosticError,
                PlanTooLarge, Invalid: it can't be carried out.
        """
        if self.repeated(asked or command, author) is not None:
            return self
        self.require_newest(made_on)
        reverts: int | None = None
        consequences: tuple[Consequence, ...] = ()
        match command:
            case EditPlan():
                mission, consequences = _edited(self.mission, command)
            case ReplacePlan():
                mission = command.mission
                if has_errors(found := check(mission)):
                    raise DiagnosticError("the mission", found)
            case UndoEdit() | RedoEdit():
                reverts = self._to_revert(command, author)
                mission = self._reverted(reverts)
        change = difference(self.mission, mission)
        require_fitting(mission, change)
        revision = Revision.model_construct(
            number=self.revision + 1,
            id=command.id,
            kind=command.kind,
            author=author,
            at=at,
            edits=command.edits if isinstance(command, EditPlan) else (),
            reverts=reverts,
            about=command.about if isinstance(command, ReplacePlan) else "",
            digest=digest_of(asked or command, author),
            change=change,
            consequences=consequences,
        )
        return self._with(revision, mission)

    def repeat(self, revision: Revision) -> "MissionPlan":
        """The plan after a revision that was made before, as it is read from a file.

        Raises ValueError if it is not the one that follows here.
        """
        if revision.number != self.revision + 1:
            raise ValueError(f"revision {revision.number} does not follow {self.revision}")
        try:
            mission = applied(self.mission, revision.change)
        except KeyError as error:
            raise ValueError(f"revision {revision.number} changes what is not there") from error
        return self._with(revision, mission)

    def before(self, revision: int) -> "MissionPlan":
        """The plan as it was before a revision of its history, without what came before that."""
        mission = self._mission_before(revision)
        return MissionPlan(mission, revision - 1)

    def _with(self, revision: Revision, mission: Mission) -> "MissionPlan":
        author, number = revision.author, revision.number
        undoable, redoable = dict(self.undoable), dict(self.redoable)
        mine, undone = undoable.get(author, ()), redoable.get(author, ())
        if revision.kind == "undo":
            undoable[author] = tuple(n for n in mine if n != revision.reverts)
            redoable[author] = (*undone, number)
        elif revision.kind == "redo":
            undoable[author] = (*mine, number)
            redoable[author] = tuple(n for n in undone if n != revision.reverts)
        else:
            undoable[author] = (*mine, number)
            redoable.pop(author, None)
        history, missions = (*self.history, revision), (*self.missions, self.mission)
        forgotten = history[0].number if len(history) > HISTORY else 0
        if forgotten:
            history, missions = history[1:], missions[1:]
            undoable = {a: tuple(n for n in ns if n > forgotten) for a, ns in undoable.items()}
            redoable = {a: tuple(n for n in ns if n > forgotten) for a, ns in redoable.items()}
        return replace(
            self,
            mission=mission,
            revision=number,
            history=history,
            missions=missions,
            undoable=undoable,
            redoable=redoable,
        )

    def _to_revert(self, command: UndoEdit | RedoEdit, author: str) -> int:
        """The revision that an author undoes, or whose undoing they take back."""
        if isinstance(command, RedoEdit):
            if not (undone := self.redoable.get(author)):
                raise NothingToUndo(f"{author} has undone nothing that could be done again")
            return undone[-1]
        mine = self.undoable.get(author, ())
        if not mine:
            raise NothingToUndo(f"{author} has changed nothing that could be undone")
        if command.revision is None:
            return mine[-1]
        if command.revision not in mine:
            raise NothingToUndo(
                f"revision {command.revision} is none of {author}'s that could be undone: "
                f"those are {', '.join(map(str, mine[-10:]))}"
            )
        return command.revision

    def _reverted(self, number: int) -> Mission:
        before, after = self._mission_before(number), self._mission_before(number + 1)
        reverted = revert(self.mission, before, after)
        if reverted.changed_since:
            raise ChangedSince(self._reason(number, reverted.changed_since))
        if found := new_errors(self.mission, reverted.mission):
            later = self.history[number - self.revision :] if number < self.revision else ()
            others = sorted({r.author for r in later})
            message = f"revision {number} can't be undone: {found[0].message}"
            if others:
                message += f"; what {' and '.join(others)} changed since may depend on it"
            raise ChangedSince(message, found)
        return reverted.mission

    def _reason(self, number: int, subjects: tuple[Subject, ...]) -> str:
        """Why a revision can't be put back: what has changed since, and by whom."""
        kind, name = subjects[0]
        what = f"`{name}`" if kind == "header" else f"{kind[:-1]} '{name}'"
        message = f"revision {number} can't be undone, as {what} is not as it left it"
        later = self.since(number) or ()
        by = [r for r in later if (kind, name) in r.change.subjects]
        if by:
            message += f": {by[-1].author} changed it in revision {by[-1].number}"
        more = len(subjects) - 1
        return message + (f", and {more} more like that" if more else "")

    def _mission_before(self, revision: int) -> Mission:
        missions = (*self.missions, self.mission)
        return missions[revision - 1 - self.revision + len(missions) - 1]


def digest_of(command: PlanCommand | ReplaceFrom, author: str) -> str:
    """Tells commands apart that have the same id."""
    content = f"{author}\n{command.model_dump_json()}"
    return hashlib.sha256(content.encode(errors="surrogatepass")).hexdigest()[:16]


def _edited(mission: Mission, command: EditPlan) -> tuple[Mission, tuple[Consequence, ...]]:
    consequences: list[Consequence] = []
    for place, edit in enumerate(command.edits):
        try:
            edited = apply(mission, edit)
        except EditError as error:
            which = f"edit {place + 1} of {len(command.edits)}: " if place else ""
            raise EditRefused(
                which + error.diagnostics[0].message, place, error.diagnostics
            ) from None
        mission = edited.mission
        consequences += edited.consequences
    return mission, tuple(consequences)
