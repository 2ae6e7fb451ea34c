"""Edit of a mission's header."""

from collections.abc import Collection, Iterable
from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.base.message import Listing, Message, identifier
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.editing.consequences import Edited, checked_edit_result
from argo_compiler.editing.errors import EditInvalid, unknown
from argo_compiler.il import Mission, Mode, Order


class HeaderFields(TypedDict, total=False):
    """Fields of a mission's header; see `Mission`."""

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
    """Set fields of the header; fields that are not given stay unchanged.

    Raises:
        EditNotFound: `current` is not the name of a task.
        EditInvalid: a value is invalid, or the header has no such field.
        EditConflict: the mission needs the removed value, such as a dock to return to.
    """
    require_known_fields(fields, HeaderFields.__annotations__, Message("the header"))
    try:
        checked = Mission.model_validate(dict(fields))
    except ValidationError as error:
        raise EditInvalid(invalid_value_diagnostics(error)) from None
    values = {name: getattr(checked, name) for name in fields}
    current = values.get("current")
    if current is not None and mission.task(current) is None:
        raise unknown("task", current, [task.name for task in mission.tasks])
    return checked_edit_result(
        mission, mission.model_copy(update=values), requested=frozenset(fields)
    )


def require_known_fields(given: Iterable[str], known: Collection[str], owner: str) -> None:
    """Raise EditInvalid if a given field is not a `known` one, which the edit can change.

    `owner` is what has the fields, for the message.
    """
    unknown_names = [name for name in given if name not in known]
    if unknown_names:
        hint = Message("the fields that can be changed: {known}", known=Listing(known))
        raise EditInvalid(
            diagnostic_of(
                "edit.value",
                Message(
                    "`{name}` is not a field of {owner} that can be changed",
                    name=identifier(name),
                    owner=owner,
                ),
                hint,
            )
            for name in unknown_names
        )


def invalid_value_diagnostics(error: ValidationError) -> list[Diagnostic]:
    """Return a diagnostic for each value that pydantic's model of the data has rejected."""
    return [
        diagnostic_of(
            "edit.value",
            _fault_message(fault["loc"], fault["msg"]),
            "give it a value that the mission format allows",
        )
        for fault in error.errors(include_url=False, include_input=False)
    ]


def _fault_message(location: tuple[int | str, ...], message: str) -> str:
    if not location:
        return Message("the edit can't be read: {message}", message=message)
    return f"`{'.'.join(map(str, location))}`: {message[:1].lower()}{message[1:]}"
