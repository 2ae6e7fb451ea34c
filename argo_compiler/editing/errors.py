"""Errors of edits that can't be made, with diagnostics, and functions that create or raise them."""

import re
import reprlib
from collections.abc import Collection, Iterable, Sequence

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.diagnostics import Diagnostic, diagnostic_of, to_text
from argo_compiler.diagnostics.subject import subject_of

_SURROGATE = re.compile("[\ud800-\udfff]")


class EditError(ArgoError):
    """Raised when an edit can't be made; `diagnostics` states why. The mission is unchanged.

    Its subclasses are `EditNotFound`, `EditInvalid` and `EditConflict`.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__(to_text(self.diagnostics, "edit"))

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.diagnostics,), vars(self)


class EditNotFound(EditError, NotFound):
    """Raised when the mission lacks the task, group, transition, condition or reaction named."""


class EditInvalid(EditError, Invalid):
    """Raised when an edit has values that are invalid for every mission."""


class EditConflict(EditError, Conflict):
    """Raised when an edit does not fit the current mission."""


def unknown(kind: str, name: str, known: Collection[str]) -> EditNotFound:
    """Return the error of an edit that names a task or group that does not exist.

    `kind` is `task` or `group`; `known` are the names that exist, for the hint.
    """
    near = nearest_name(name, known)
    return EditNotFound(
        [
            diagnostic_of(
                f"edit.unknown-{kind}",
                Message("the mission has no task '{name}'", name=name)
                if kind == "task"
                else Message("the mission has no group '{name}'", name=name),
                Message("is '{near}' meant?", near=near)
                if near
                else Message("name a task of the mission")
                if kind == "task"
                else Message("name a group of the mission"),
            )
        ]
    )


def ambiguous(name: str) -> EditConflict:
    """Return the error of an edit of one task where several tasks have its name."""
    message = Message("more than one task is named '{name}'", name=name)
    hint = Message("give each task of the mission its own name first")
    return conflict("edit.ambiguous-task", message, hint, subject_of("tasks", name))


def require_single_position(name: str, positions: Sequence[int], known: Collection[str]) -> int:
    """Return the position of the only task with a name.

    `positions` are those of the tasks with this name; `known` are the names of all tasks.
    Raises EditNotFound if there is no such task, EditConflict if there are several.
    """
    if not positions:
        raise unknown("task", name, known)
    if len(positions) > 1:
        raise ambiguous(name)
    return positions[0]


def name_taken(kind: str, name: str, subject: str) -> EditConflict:
    """Return the error of a name that another task or group already has.

    `kind` is `task` or `group`; `subject` is the path of the one that has the name.
    """
    if kind == "task":
        hint = Message("choose another name, or rename the task that has it")
        message = Message("a task '{name}' already exists", name=name)
    else:
        hint = Message("choose another name, or rename the group that has it")
        message = Message("a group '{name}' already exists", name=name)
    return conflict("edit.name-taken", message, hint, subject)


def conflict(code: str, message: str, hint: str, subject: str | None = None) -> EditConflict:
    """Return an EditConflict with one diagnostic."""
    return EditConflict([diagnostic_of(code, message, hint, subject)])


def invalid(code: str, message: str, hint: str) -> EditInvalid:
    """Return an EditInvalid with one diagnostic."""
    return EditInvalid([diagnostic_of(code, message, hint)])


def require_kind(value: object, kind: type, what: str) -> None:
    """Raise EditInvalid if a value is not of the type `kind`; messages call the value `what`."""
    if not isinstance(value, kind):
        message = Message(
            "{what} must be a {name}, not {value}",
            what=what,
            name=kind.__name__,
            value=reprlib.repr(value),
        )
        raise invalid("edit.value", message, Message("pass a {name} instead", name=kind.__name__))


def require_name(thing: str, name: object) -> None:
    """Raise EditInvalid if a value can't be the name of a task or group, called `thing`."""
    if not isinstance(name, str):
        message, hint = (
            Message(
                "{thing} needs a text as its name, not {name}", thing=thing, name=reprlib.repr(name)
            ),
            Message("give it a name"),
        )
    elif not name:
        message, hint = (
            Message("{thing} needs a name that is not empty", thing=thing),
            Message("give it a name"),
        )
    elif _SURROGATE.search(name):
        message = Message(
            "{thing} can't be named {name}, which contains half a character",
            thing=thing,
            name=ascii(name),
        )
        hint = Message("leave out the surrogates, which can't be written to a file")
    else:
        return
    raise invalid("edit.value", message, hint)
