"""Edits of a mission's header."""

from collections.abc import Collection, Iterable
from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.editing.consequences import Edited, edited
from argo_compiler.editing.refusals import EditInvalid, unknown
from argo_compiler.il import Mission, Mode, Order


class HeaderFields(TypedDict, total=False):
    """The fields of a mission's header; see `Mission`."""

    designation: str
    site: str
    mode: Mode
    max_duration: float | None
    start_area: int | None
    end_area: int | None
    dock: Pose | None
    order: Order
    anomaly_specification: str
    real_time_reporting: str
    after_mission_report: str
    current: str | None
    left_out: tuple[str, ...]
    before: tuple[tuple[str, str], ...]


def set_header(mission: Mission, **fields: Unpack[HeaderFields]) -> Edited:
    """The mission with other values of the fields that are given.

    Raises:
        EditNotFound: `current` is no task.
        EditInvalid: a value that the field can't have, or a field that the header does not have.
        EditConflict: the mission needs what is taken away, as a dock to return to.
    """
    require_fields(fields, HeaderFields.__annotations__, "the header")
    try:
        checked = Mission.model_validate(dict(fields))
    except ValidationError as error:
        raise EditInvalid(wrong_values(error)) from None
    values = {name: getattr(checked, name) for name in fields}
    current = values.get("current")
    if current is not None and mission.task(current) is None:
        raise unknown("task", current, [task.name for task in mission.tasks])
    return edited(mission, mission.model_copy(update=values), asked=frozenset(fields))


def require_fields(given: Iterable[str], known: Collection[str], of: str) -> None:
    """Raises EditInvalid for fields that are not among those that an edit can change."""
    wrong = [name for name in given if name not in known]
    if wrong:
        hint = f"the fields that can be changed: {', '.join(known)}"
        raise EditInvalid(
            diagnostic_of("edit.value", f"`{name}` is no field of {of} that can be changed", hint)
            for name in wrong
        )


def wrong_values(error: ValidationError) -> list[Diagnostic]:
    """What is said of values that a field can't have."""
    return [
        diagnostic_of(
            "edit.value",
            _said(fault["loc"], fault["msg"]),
            "give it a value that the mission format allows",
        )
        for fault in error.errors(include_url=False, include_input=False)
    ]


def _said(place: tuple[int | str, ...], message: str) -> str:
    if not place:
        return f"the edit can't be read: {message}"
    return f"`{'.'.join(map(str, place))}`: {message[:1].lower()}{message[1:]}"
