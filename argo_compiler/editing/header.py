"""Edits of a mission's header."""

from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.editing.consequences import Edited, edited
from argo_compiler.editing.refusals import EditInvalid, diagnostic, unknown
from argo_compiler.il import Mission, Mode, Order
from argo_compiler.model import Pose


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


def set_header(mission: Mission, **fields: Unpack[HeaderFields]) -> Edited:
    """The mission with other values of the fields that are given.

    Raises:
        EditNotFound: `current` is no task.
        EditInvalid: a value that the field can't have.
        EditConflict: the mission needs what is taken away, as a dock to return to.
    """
    try:
        checked = Mission.model_validate(dict(fields))
    except ValidationError as error:
        raise EditInvalid(wrong_values(error)) from None
    values = {name: getattr(checked, name) for name in fields}
    current = values.get("current")
    if current is not None and mission.task(current) is None:
        raise unknown("task", current, [task.name for task in mission.tasks])
    return edited(mission, mission.model_copy(update=values), asked=frozenset(fields))


def wrong_values(error: ValidationError) -> list[Diagnostic]:
    """What is said of values that a field can't have."""
    return [
        diagnostic(
            "edit.value",
            f"`{'.'.join(map(str, fault['loc']))}`: {fault['msg'][:1].lower()}{fault['msg'][1:]}",
            "give it a value that the mission format allows",
        )
        for fault in error.errors(include_url=False, include_input=False)
    ]
