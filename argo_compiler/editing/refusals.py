"""What stands in the way of an edit, as errors of a kind, with diagnostics."""

import re
import reprlib
from collections.abc import Collection, Iterable, Sequence

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.diagnostics import Diagnostic, diagnostic_of, to_text
from argo_compiler.diagnostics.subject import subject_of

_SURROGATE = re.compile("[\ud800-\udfff]")


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


def unknown(kind: str, name: str, known: Collection[str]) -> EditNotFound:
    """The refusal of an edit that names a task or group that is not there."""
    near = nearest_name(name, known)
    return EditNotFound(
        [
            diagnostic_of(
                f"edit.unknown-{kind}",
                f"the mission has no {kind} '{name}'",
                f"is '{near}' meant?" if near else f"name a {kind} of the mission",
            )
        ]
    )


def ambiguous(name: str) -> EditConflict:
    """The refusal of an edit of one task where several have its name."""
    message = f"more than one task is named '{name}'"
    hint = "write the mission with a name for each task first"
    return conflict("edit.ambiguous-task", message, hint, subject_of("tasks", name))


def only_one(name: str, places: Sequence[int], known: Collection[str]) -> int:
    """The only one of the places at which tasks have a name; `known` are all names. Raises
    EditNotFound if there is none, EditConflict if there are several."""
    if not places:
        raise unknown("task", name, known)
    if len(places) > 1:
        raise ambiguous(name)
    return places[0]


def name_taken(kind: str, name: str, subject: str) -> EditConflict:
    """The refusal of a name that something else has."""
    hint = f"choose another name, or rename the {kind} that has it"
    message = f"there is a {kind} '{name}' already"
    return conflict("edit.name-taken", message, hint, subject)


def conflict(code: str, message: str, hint: str, subject: str | None = None) -> EditConflict:
    """A refusal for one reason."""
    return EditConflict([diagnostic_of(code, message, hint, subject)])


def invalid(code: str, message: str, hint: str) -> EditInvalid:
    """A refusal of what was given."""
    return EditInvalid([diagnostic_of(code, message, hint)])


def require_kind(value: object, kind: type, what: str) -> None:
    """Raises EditInvalid for what is not of a kind."""
    if not isinstance(value, kind):
        message = f"{what} is to be a {kind.__name__}, not {reprlib.repr(value)}"
        raise invalid("edit.value", message, f"make a {kind.__name__} of it")


def require_name(thing: str, name: object) -> None:
    """Raises EditInvalid for what can't be the name of a task or group."""
    if not isinstance(name, str):
        message, hint = (
            f"{thing} needs a text as its name, not {reprlib.repr(name)}",
            "give it a name",
        )
    elif not name:
        message, hint = f"{thing} needs a name that is not empty", "give it a name"
    elif _SURROGATE.search(name):
        message = f"{thing} can't be named {name!a}, which has half a character"
        hint = "leave out the surrogates, which can't be written to a file"
    else:
        return
    raise invalid("edit.value", message, hint)
