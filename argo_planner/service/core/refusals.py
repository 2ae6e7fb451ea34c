"""Errors of commands that are refused, by kind; the plan is left unchanged."""

from collections.abc import Iterable

from argo_compiler.base.errors import ArgoError, Conflict, Invalid
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic
from argo_planner.service.core.commands import Revision


class StaleRevision(Conflict):
    """Raised when a command was made on a revision that is not the newest one.

    `since` has the revisions since then; None if they are no longer known.
    """

    code = "stale-revision"

    def __init__(
        self, made_on: int, newest: int, since: tuple[Revision, ...] | None = None
    ) -> None:
        self.made_on, self.newest, self.since = made_on, newest, since
        super().__init__(
            Message(
                "the command was made on revision {made_on}, but the mission is at "
                "revision {newest}: read the changes since then, and send the command "
                "again on the newest revision",
                made_on=made_on,
                newest=newest,
            )
        )

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.made_on, self.newest, self.since), vars(self)


class CommandIdTaken(Conflict):
    """Raised when another command has used this id."""

    code = "command-id-taken"


class NothingToUndo(Conflict):
    """Raised when the author has no change to undo or to redo."""

    code = "nothing-to-undo"


class ChangedSince(Conflict):
    """Raised when a change can't be reverted: later changes replace it, or depend on it."""

    code = "changed-since"

    def __init__(self, message: str, diagnostics: Iterable[Diagnostic] = ()) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__(message)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.diagnostics), vars(self)


class FiledSince(Conflict):
    """Raised when a mission is no longer in the folder that the author has seen it in."""

    code = "filed-since"

    def __init__(self, name: str, folder: str) -> None:
        self.name, self.folder = name, folder
        there = Message("in no folder")
        if folder:
            there = Message("in the folder '{folder}'", folder=folder)
        super().__init__(
            Message(
                "somebody has moved '{name}' in the meantime: it is {there}; move it from there",
                name=name,
                there=there,
            )
        )

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.name, self.folder), vars(self)


class EditRefused(ArgoError):
    """Raised when an edit can't be made; `diagnostics` state the reasons."""

    code = "edit-refused"

    def __init__(self, message: str, place: int, diagnostics: Iterable[Diagnostic]) -> None:
        self.place = place
        """index of the edit in its command, from 0"""
        self.diagnostics = tuple(diagnostics)
        super().__init__(message)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.place, self.diagnostics), vars(self)


class PlanTooLarge(Invalid):
    """Raised when a plan would be larger than the service allows: tasks, texts or its file."""

    code = "plan-too-large"
