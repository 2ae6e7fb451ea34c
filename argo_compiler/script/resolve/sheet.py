"""From a sheet to its mission: checkpoints and starting areas are looked up and chosen."""

from typing import Literal

from argo_compiler.catalog import Area
from argo_compiler.diagnostics import Span
from argo_compiler.errors import Remedy
from argo_compiler.il import Mission, Mode, Order
from argo_compiler.listing import listed
from argo_compiler.script.resolve.assembly import assemble
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.plan import Plan, dock_item, measure_item, start_item
from argo_compiler.script.syntax.nodes import AreaField, Sheet, TextField
from argo_compiler.script.syntax.source import Diagnostics


def sheet_mission(
    sheet: Sheet,
    lookup: Lookup,
    diagnostics: Diagnostics,
    start_area: int | None,
    end_area: int | None,
) -> Mission | None:
    """The mission of the sheet; None if `diagnostics` has an error."""
    whole = not diagnostics.errors
    checkpoints = [(step, lookup.checkpoint(step.checkpoint)) for step in sheet.steps]
    start = _choose_area("start", sheet.initial_position, start_area, lookup, whole)
    # Without the cell and the option the mission ends at its last checkpoint.
    ends_docked = sheet.end_of_mission is not None or end_area is not None
    end = None
    if ends_docked:
        end = _choose_area("end", sheet.end_of_mission, end_area, lookup, whole)
    if whole:
        _check_fields(sheet, ends_docked, diagnostics)
    if diagnostics.errors or start is None:
        return None

    plan = Plan()
    plan.append(start_item(start.dock, _span(sheet.initial_position)))
    for step, checkpoint in checkpoints:
        if checkpoint is not None:
            plan.append(measure_item(checkpoint.id, step.span))
    if end is not None:
        plan.append(dock_item(end.dock, _span(sheet.end_of_mission)))
    tasks, groups = assemble(plan, diagnostics)
    return Mission(
        designation=_text(sheet.designation),
        site=lookup.catalog.site,
        mode=sheet.mode.mode if sheet.mode else Mode.AUTONOMOUS,
        max_duration=sheet.max_duration.seconds if sheet.max_duration else None,
        start_area=start.number,
        end_area=end.number if end else None,
        dock=(end or start).dock,
        order=sheet.order.order if sheet.order else Order.PRECISE,
        anomaly_specification=_text(sheet.anomaly_specification),
        real_time_reporting=_text(sheet.real_time_reporting),
        after_mission_report=_text(sheet.after_mission_report),
        tasks=tasks,
        groups=groups,
    )


def _text(field: TextField | None) -> str:
    return field.text if field else ""


def _span(field: AreaField | None) -> Span | None:
    return field.span if field else None


def _choose_area(
    which: Literal["start", "end"],
    field: AreaField | None,
    option: int | None,
    lookup: Lookup,
    whole: bool,
) -> Area | None:
    """The area among those that the field offers; more than one leaves the choice to `option`.

    In a sheet that is not understood as a whole, a line may be what seems to be missing.
    """
    diagnostics = lookup.diagnostics
    remedies = (Remedy.CHOOSE_START if which == "start" else Remedy.CHOOSE_END,)
    offered = sorted({area.value for area in field.areas}) if field else []
    span = field.areas[0].span if field and field.areas else _span(field)
    areas = listed(offered, "or")
    if option is not None and offered and option not in offered:
        message = f"the {which} in area {option} is not what the sheet offers"
        diagnostics.error("area-not-offered", message, span, f"choose area {areas}", remedies)
        return None
    if option is not None:
        return lookup.area(option, span)
    if len(offered) == 1:
        return lookup.area(offered[0], span)
    if offered:
        message = f"the sheet leaves the {which} to the preparation: starting area {areas}"
        diagnostics.error("area-choice", message, span, f"choose area {areas}", remedies)
    elif whole:
        message = f"the sheet names no starting area for the mission's {which}"
        known = listed((area.number for area in lookup.catalog.areas), "or")
        hint = f"name one in the sheet, or choose area {known}"
        diagnostics.error("no-area", message, span, hint, remedies)
    return None


def _check_fields(sheet: Sheet, ends_docked: bool, diagnostics: Diagnostics) -> None:
    if not sheet.steps:
        message = "the sheet has no checkpoints, so there is nothing to do"
        hint = "list them: `1. Checkpoint #1: read the value on pressure gauge 1`"
        diagnostics.error("nothing-to-do", message, None, hint)
    assumed = {
        "main mode": (sheet.mode, "autonomous is assumed"),
        "maximum total duration": (sheet.max_duration, "there is no limit"),
        "order of the checkpoints": (sheet.order, "the precise order is assumed"),
        "end of the mission": (ends_docked or None, "it ends at its last checkpoint"),
    }
    for name, (field, consequence) in assumed.items():
        if field is None:
            diagnostics.warning("missing-field", f"the sheet has no {name}; {consequence}", None)
