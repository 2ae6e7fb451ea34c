"""What stands in the way of an edit, as errors of a kind, with diagnostics."""

from collections.abc import Collection, Iterable

from argo_compiler.diagnostics import Diagnostic, Severity, to_text
from argo_compiler.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.nearest_name import nearest_name


class EditError(ArgoError):
    """An edit that can't be made; `diagnostics` names what is in the way. The mission is as it was.

    Its kinds are `EditNotFound`, `EditInvalid` and `EditConflict`.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__(to_text(self.diagnostics, "edit"))

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.diagnostics,), vars(self)


class EditNotFound(EditError, NotFound):
    """The edit names a task, group, transition or reaction that the mission does not have."""


class EditInvalid(EditError, Invalid):
    """What the edit says makes no sense, whatever the mission is."""


class EditConflict(EditError, Conflict):
    """The edit does not fit the mission as it is."""


def diagnostic(code: str, message: str, hint: str, subject: str | None = None) -> Diagnostic:
    """What is said about an edit."""
    return Diagnostic(
        code=code, severity=Severity.ERROR, message=message, hint=hint, subject=subject
    )


def unknown(kind: str, name: str, known: Collection[str]) -> EditNotFound:
    """The refusal of an edit that names a task or group that is not there."""
    near = nearest_name(name, known)
    return EditNotFound(
        [
            diagnostic(
                f"edit.unknown-{kind}",
                f"the mission has no {kind} '{name}'",
                f"is '{near}' meant?" if near else f"name a {kind} of the mission",
            )
        ]
    )


def name_taken(kind: str, name: str, subject: str) -> EditConflict:
    """The refusal of a name that something else has."""
    hint = f"choose another name, or rename the {kind} that has it"
    message = f"there is a {kind} '{name}' already"
    return EditConflict([diagnostic("edit.name-taken", message, hint, subject)])


def conflict(code: str, message: str, hint: str, subject: str | None = None) -> EditConflict:
    """A refusal for one reason."""
    return EditConflict([diagnostic(code, message, hint, subject)])


def invalid(code: str, message: str, hint: str) -> EditInvalid:
    """A refusal of what was given."""
    return EditInvalid([diagnostic(code, message, hint)])
