"""From a protocol to its mission: its commands are carried out one after the other."""

from argo_compiler.il import Mission, Mode, Order
from argo_compiler.script.resolve.assembly import assemble
from argo_compiler.script.resolve.header import header_values
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.planning import Planner
from argo_compiler.script.syntax.nodes import Protocol, TextField
from argo_compiler.script.syntax.source import Diagnostics


def protocol_mission(
    protocol: Protocol,
    lookup: Lookup,
    diagnostics: Diagnostics,
    start_area: int | None,
    end_area: int | None,
) -> Mission | None:
    """The mission of the protocol; None if `diagnostics` has an error.

    `start_area` is for a protocol that sets no starting point of its own, or must agree with it;
    `end_area` adds the way into that area's docking station, or must agree with it.
    """
    header = header_values(protocol, diagnostics, start_area, end_area)
    planner = Planner(lookup, diagnostics, header)
    numbered = any(step.number is not None for step in protocol.steps)
    for i, step in enumerate(protocol.steps, start=1):
        planner.begin_step(step.number if numbered else i)
        for command in step.commands:
            planner.carry_out(command)
    planner.finish()
    if diagnostics.errors:
        return None
    tasks, groups = assemble(planner.plan, diagnostics, planner.steps)
    current = planner.current_name(protocol, tasks)
    if diagnostics.errors:
        return None
    return Mission(
        designation=_designation(protocol),
        site=_site(protocol, lookup, diagnostics),
        mode=protocol.mode.mode if protocol.mode else Mode.AUTONOMOUS,
        max_duration=protocol.max_duration.seconds if protocol.max_duration else None,
        start_area=planner.start_area,
        end_area=planner.end_area,
        dock=planner.dock,
        order=protocol.order.order if protocol.order else Order.PRECISE,
        anomaly_specification=_text(protocol.anomaly_specification),
        real_time_reporting=_text(protocol.real_time_reporting),
        after_mission_report=_text(protocol.after_mission_report),
        tasks=tasks,
        groups=groups,
        reactions=tuple(planner.reactions),
        current=current,
        left_out=protocol.left_out.tasks if protocol.left_out else (),
    )


def _text(field: TextField | None) -> str:
    return field.text if field else ""


def _designation(protocol: Protocol) -> str:
    return _text(protocol.designation or protocol.title)


def _site(protocol: Protocol, lookup: Lookup, diagnostics: Diagnostics) -> str:
    site = lookup.catalog.site
    if protocol.site is None:
        return site
    if protocol.site.text.lower() != site.lower():
        message = (
            f"the script is for `{protocol.site.text}`; it is read with the catalogue of {site}"
        )
        hint = "are its checkpoints and places those of the other site?"
        diagnostics.warning("other-site", message, protocol.site.span, hint)
        return protocol.site.text
    return protocol.site.text
