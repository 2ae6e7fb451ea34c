"""Mission plan: a mission with its revisions, and the execution of commands on it."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.editing import Consequence, EditError
from argo_compiler.editing.commands import apply
from argo_compiler.editing.consequences import new_errors
from argo_compiler.il import Mission
from argo_planner.service.core.change import apply_change, mission_change
from argo_planner.service.core.commands import (
    EditPlan,
    PlanCommand,
    RedoEdit,
    ReplaceFrom,
    ReplacePlan,
    Revision,
    UndoEdit,
)
from argo_planner.service.core.plan_limits import require_within_limits
from argo_planner.service.core.refusals import (
    ChangedSince,
    CommandIdTaken,
    EditRefused,
    NothingToUndo,
    StaleRevision,
)
from argo_planner.service.core.reverting import Subject, revert

HISTORY = 500
"""number of revisions that are stored and can be undone"""

Stacks = Mapping[str, tuple[int, ...]]
"""revisions by author, the newest one last"""


@dataclass(frozen=True)
class MissionPlan:
    """Mission with its history, immutable: each command returns a new plan."""

    mission: Mission
    revision: int = 1
    """number of the mission's state; 1 in a new plan"""
    history: tuple[Revision, ...] = ()
    """the last revisions, up to the present one"""
    missions: tuple[Mission, ...] = ()
    """the mission before the first revision of the history, then after each one except the last"""
    undoable: Stacks = field(default_factory=dict)
    redoable: Stacks = field(default_factory=dict)

    def revisions_after(self, revision: int) -> tuple[Revision, ...] | None:
        """Return the revisions after the given one, in order.

        The result is empty for the newest revision, and None if not all later ones are in the
        history, or the given one does not exist yet.
        """
        count = self.revision - revision
        if not 0 <= count <= len(self.history):
            return None
        return self.history[len(self.history) - count :]

    def require_newest(self, made_on: int | None) -> None:
        """Raise StaleRevision if `made_on` is not the plan's newest revision; None: any will do."""
        if made_on is not None and made_on != self.revision:
            raise StaleRevision(made_on, self.revision, self.revisions_after(made_on))

    def find_revision_made_by(
        self, command: PlanCommand | ReplaceFrom, author: str
    ) -> Revision | None:
        """Return the revision that the command has made, or None if the history has none.

        Raises CommandIdTaken if another command has used its id.
        """
        known = next((r for r in self.history if r.id == command.id), None)
        if known is not None and known.digest != command_digest(command, author):
            raise CommandIdTaken(
                Message(
                    "another command has used the id {id}: give each command its own id",
                    id=command.id,
                )
            )
        return known

    def execute(
        self,
        command: PlanCommand,
        author: str,
        made_on: int | None,
        at: datetime,
        request: ReplaceFrom | None = None,
    ) -> "MissionPlan":
        """Return the plan after a command; its last revision states what changed.

        A command that was executed before is not executed again: the plan is returned unchanged.
        Such a command is recognized by its `request` if there is one.

        Args:
            command: The command.
            author: Its author.
            made_on: The revision that the command was made on; None allows any revision.
            at: The present time.
            request: The request that the command was made from.

        Raises:
            StaleRevision: The plan is at another revision than `made_on`.
            EditRefused, ChangedSince, NothingToUndo, CommandIdTaken, DiagnosticError,
                PlanTooLarge, Invalid: The command can't be executed.
        """
        if self.find_revision_made_by(request or command, author) is not None:
            return self
        self.require_newest(made_on)
        reverts: int | None = None
        consequences: tuple[Consequence, ...] = ()
        match command:
            case EditPlan():
                mission, consequences = _apply_edits(self.mission, command)
            case ReplacePlan():
                mission = command.mission
                if has_errors(found := check(mission)):
                    raise DiagnosticError("the mission", found)
            case UndoEdit() | RedoEdit():
                reverts = self._revision_to_revert(command, author)
                mission = self._revert(reverts)
        change = mission_change(self.mission, mission)
        require_within_limits(mission, change)
        revision = Revision.model_construct(
            number=self.revision + 1,
            id=command.id,
            kind=command.kind,
            author=author,
            at=at,
            edits=command.edits if isinstance(command, EditPlan) else (),
            reverts=reverts,
            about=command.about if isinstance(command, ReplacePlan) else "",
            digest=command_digest(request or command, author),
            change=change,
            consequences=consequences,
        )
        return self._with_revision(revision, mission)

    def with_next_revision(self, revision: Revision) -> "MissionPlan":
        """Return a copy of the plan after a revision that was made before, such as one in a file.

        Raises ValueError if the revision does not follow the plan's present one, or its change does
        not fit the mission.
        """
        if revision.number != self.revision + 1:
            raise ValueError(f"revision {revision.number} does not follow {self.revision}")
        try:
            mission = apply_change(self.mission, revision.change)
        except KeyError as error:
            raise ValueError(f"revision {revision.number} does not fit the mission") from error
        return self._with_revision(revision, mission)

    def plan_before(self, revision: int) -> "MissionPlan":
        """Return the plan as it was before a revision of its history, with an empty history.

        Raises NotFound if the history does not have that revision.
        """
        if revision not in {made.number for made in self.history}:
            raise NotFound(
                Message(
                    "revision {revision} is not in the history of the mission", revision=revision
                )
            )
        mission = self._mission_before(revision)
        return MissionPlan(mission, revision - 1)

    def _with_revision(self, revision: Revision, mission: Mission) -> "MissionPlan":
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
        evicted = history[0].number if len(history) > HISTORY else 0
        if evicted:
            history, missions = history[1:], missions[1:]
            undoable = {a: tuple(n for n in ns if n > evicted) for a, ns in undoable.items()}
            redoable = {a: tuple(n for n in ns if n > evicted) for a, ns in redoable.items()}
        return replace(
            self,
            mission=mission,
            revision=number,
            history=history,
            missions=missions,
            undoable=undoable,
            redoable=redoable,
        )

    def _revision_to_revert(self, command: UndoEdit | RedoEdit, author: str) -> int:
        """Return the revision of the author's edit to undo, or of the author's undo to revert.

        Raises NothingToUndo if there is none, or it can't be undone.
        """
        if isinstance(command, RedoEdit):
            if not (undone := self.redoable.get(author)):
                raise NothingToUndo(
                    Message("nothing to redo: {author} has undone no change", author=author)
                )
            return undone[-1]
        mine = self.undoable.get(author, ())
        if not mine:
            raise NothingToUndo(
                Message(
                    "nothing to undo: {author} has made no change that can be undone", author=author
                )
            )
        if command.revision is None:
            return mine[-1]
        if command.revision not in mine:
            raise NothingToUndo(
                Message(
                    "{author} can't undo revision {revision}: choose one of {names}",
                    author=author,
                    revision=command.revision,
                    names=Listing(map(str, mine[-10:])),
                )
            )
        return command.revision

    def _revert(self, number: int) -> Mission:
        before, after = self._mission_before(number), self._mission_before(number + 1)
        reverted = revert(self.mission, before, after)
        if reverted.changed_since:
            raise ChangedSince(self._reason(number, reverted.changed_since))
        if found := new_errors(self.mission, reverted.mission):
            later = self.history[number - self.revision :] if number < self.revision else ()
            others = sorted({r.author for r in later})
            message = Message(
                "revision {number} can't be undone: {message}",
                number=number,
                message=found[0].message,
            )
            if others:
                message += Message(
                    "; later changes by {others:and} may depend on it", others=Listing(others)
                )
            raise ChangedSince(message, found)
        return reverted.mission

    def _reason(self, number: int, subjects: tuple[Subject, ...]) -> str:
        """Return why a revision can't be reverted: what was changed later, and by whom."""
        kind, name = subjects[0]
        what = f"`{name}`" if kind == "header" else f"{kind[:-1]} '{name}'"
        message = Message(
            "revision {number} can't be undone: {what} was changed later", number=number, what=what
        )
        later = self.revisions_after(number) or ()
        by = [r for r in later if (kind, name) in r.change.subjects]
        if by:
            message += Message(
                ", by {author} in revision {number}", author=by[-1].author, number=by[-1].number
            )
        more = len(subjects) - 1
        return message + (Message("; so were {more} more parts", more=more) if more else "")

    def _mission_before(self, revision: int) -> Mission:
        missions = (*self.missions, self.mission)
        return missions[revision - 1 - self.revision + len(missions) - 1]


def command_digest(command: PlanCommand | ReplaceFrom, author: str) -> str:
    """Return a digest of a command and its author, to tell commands with the same id apart."""
    content = f"{author}\n{command.model_dump_json()}"
    return hashlib.sha256(content.encode(errors="surrogatepass")).hexdigest()[:16]


def _apply_edits(mission: Mission, command: EditPlan) -> tuple[Mission, tuple[Consequence, ...]]:
    consequences: list[Consequence] = []
    for index, edit in enumerate(command.edits):
        try:
            edited = apply(mission, edit)
        except EditError as error:
            which = (
                Message("edit {index} of {count}: ", index=index + 1, count=len(command.edits))
                if index
                else ""
            )
            raise EditRefused(
                which + error.diagnostics[0].message, index, error.diagnostics
            ) from None
        mission = edited.mission
        consequences += edited.consequences
    return mission, tuple(consequences)
