"""Why a command is refused, in kinds that a program can tell apart. The plan is as it was."""

from collections.abc import Iterable

from argo_compiler.base.errors import ArgoError, Conflict, Invalid
from argo_compiler.diagnostics import Diagnostic
from argo_planner.service.core.commands import Revision


class StaleRevision(Conflict):
    """The command was made on a revision that is not the newest one; `since` is what was done since
    then, None if that is not known."""

    code = "stale-revision"

    def __init__(
        self, made_on: int, newest: int, since: tuple[Revision, ...] | None = None
    ) -> None:
        self.made_on, self.newest, self.since = made_on, newest, since
        super().__init__(
            f"the command was made on revision {made_on}, and the plan is at revision {newest}: "
            "look at what has changed since, and send it again on that"
        )

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.made_on, self.newest, self.since), vars(self)


class CommandIdTaken(Conflict):
    """Another command has had this id."""

    code = "command-id-taken"


class NothingToUndo(Conflict):
    """The author has changed nothing that could be undone, or undone nothing to be done again."""

    code = "nothing-to-undo"


class ChangedSince(Conflict):
    """What is to be undone has been changed by somebody else, or is needed by what they did."""

    code = "changed-since"

    def __init__(self, message: str, diagnostics: Iterable[Diagnostic] = ()) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__(message)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.diagnostics), vars(self)


class EditRefused(ArgoError):
    """An edit can't be made; `diagnostics` tell what is in the way."""

    code = "edit-refused"

    def __init__(self, message: str, place: int, diagnostics: Iterable[Diagnostic]) -> None:
        self.place = place
        """of the edit in its command, from 0"""
        self.diagnostics = tuple(diagnostics)
        super().__init__(message)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.place, self.diagnostics), vars(self)


class PlanTooLarge(Invalid):
    """The plan would have more tasks, or longer texts, than the service takes."""

    code = "plan-too-large"
