"""Syntax tree to mission."""

from contextlib import suppress
from functools import cache

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.il import Mission, Mode
from argo_compiler.script.documents.source import Diagnostics, RefusedError
from argo_compiler.script.parsing.script import Script
from argo_compiler.script.resolve.assembly import assemble
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.lowering import lower_program
from argo_compiler.script.resolve.planning import Planner
from argo_compiler.script.resolve.program import Do, all_nodes, depth
from argo_compiler.script.resolve.starting import Starting, area_choices
from argo_compiler.script.sentences.tree.places import Steps
from argo_compiler.script.sentences.tree.script import ScriptHeader

_DEEPEST = 100


class Resolved(Model):
    """A script's mission, and the warnings that were met on the way."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...] = ()


@collector_held()
def resolve_script(
    script: Script, catalog: Catalog, start_area: int | None = None, end_area: int | None = None
) -> Resolved:
    """The mission that the script asks for on the catalogue's site."""
    diagnostics = Diagnostics(script.source, list(script.diagnostics))
    try:
        mission = _mission(script, catalog, diagnostics, start_area, end_area)
    except RefusedError:
        raise DiagnosticError(script.source_name, diagnostics.by_place()) from None
    return Resolved(mission=mission, diagnostics=diagnostics.by_place())


def _mission(
    script: Script,
    catalog: Catalog,
    diagnostics: Diagnostics,
    start_area: int | None,
    end_area: int | None,
) -> Mission:
    start, end = area_choices(script.header, diagnostics, start_area, end_area)
    lookup = Lookup(catalog, diagnostics, start.area, end.area)
    context = Context(lookup, diagnostics)
    if diagnostics.errors:
        context.fail()
    starting = Starting(context, script.header, start, end)
    planner = Planner(context, starting, script.header)
    ordering = planner.ordering
    planner.steps(script.steps)
    planner.finish()
    with suppress(RefusedError):
        starting.finish()
    planner.cases.finish()
    planner.repeating.finish()
    _warn_of_long_waits(context, script.header)
    order = ordering.finish(context.program)
    _require_no_error(diagnostics)
    if depth(context.program) > _DEEPEST:
        message = f"more than {_DEEPEST} repetitions or conditions are nested"
        hint = "nest fewer of them, and repeat the steps more often"
        diagnostics.refuse("deep-rounds", message, None, hint)
    lowered = lower_program(context.program, cache(context.target_of), starting.home)
    for leave in lowered.circling:
        hint = "name a step that measures, drives or waits"
        diagnostics.error("empty-step", "this leads only back to itself", leave.span, hint)
    tasks, groups, names = assemble(lowered, diagnostics)
    _require_no_error(diagnostics)
    said = script.header
    text = said.designation or said.title
    if said.designation and said.title and not said.format_title:
        message = f"`{said.title.text}` has no effect, because the script has another designation"
        diagnostics.warning("no-effect", message, said.title.span)
    mission = Mission(
        designation=text.text if text else "",
        site=_site(script, catalog, diagnostics),
        mode=said.mode or Mode.AUTONOMOUS,
        max_duration=said.max_duration[0] if said.max_duration else None,
        start_area=starting.start_area,
        end_area=starting.end_area,
        dock=starting.dock,
        order=order,
        anomaly_specification=said.anomaly_specification.text if said.anomaly_specification else "",
        real_time_reporting=said.real_time_reporting.text if said.real_time_reporting else "",
        after_mission_report=said.after_mission_report.text if said.after_mission_report else "",
        tasks=tasks,
        groups=groups,
        reactions=tuple(context.reactions.found),
        current=_current(said.current, context, names),
        left_out=said.left_out,
        before=ordering.named(names),
    )
    ordering.check(mission)
    _warn_of_time(mission, diagnostics)
    _require_no_error(diagnostics)
    return mission


def _warn_of_time(mission: Mission, diagnostics: Diagnostics) -> None:
    """Warns where something is done if there is time, and nothing says how much there is."""
    optional = next((task for task in mission.tasks if task.optional), None)
    if optional is None or mission.max_duration is not None:
        return
    if all(task.window is None or task.window.latest is None for task in mission.tasks):
        message = "the mission has no time limit, so there is always time for this"
        hint = "add a limit: `Maximum duration: 30 min`"
        diagnostics.warning("no-time-limit", message, optional.source, hint)


def _warn_of_long_waits(context: Context, header: ScriptHeader) -> None:
    """Warns of each wait that lasts at least as long as the whole mission may take."""
    if header.max_duration is None:
        return
    most_s = header.max_duration[0]
    for do in all_nodes(context.program):
        if not isinstance(do, Do) or do.wait is None or (do.wait.duration or 0) < most_s:
            continue
        message = f"this wait takes {do.wait.duration:g} s, but the whole mission may take only "
        message += f"{most_s:g} s"
        hint = "wait for a shorter time, or raise the limit of the mission"
        context.diagnostics.warning("long-wait", message, do.source, hint)


def _require_no_error(diagnostics: Diagnostics) -> None:
    if diagnostics.errors:
        raise RefusedError


def _current(said: Steps | None, context: Context, names: dict[int, str]) -> str | None:
    """The name of the task that a script calls the current one."""
    if said is None:
        return None
    (point,) = said.points
    if isinstance(point, str):
        return point
    nodes = context.nodes_of(said)
    tasks = [node for node in all_nodes(nodes) if isinstance(node, Do)]
    if not tasks and nodes:
        message = f"step {point} has no task"
        context.diagnostics.refuse("empty-step", message, said.span, "name another step")
    return names[id(tasks[0])] if tasks else None


def _site(script: Script, catalog: Catalog, diagnostics: Diagnostics) -> str:
    """The site that the script says it is for, else that of the catalogue."""
    site, said = catalog.site, script.header.site
    if said is None:
        return site
    if said.text.lower() != site.lower():
        message = f"the script is for `{said.text}`; it was read with the names of {site}"
        hint = "choose the other site, or check that the names are those of this one"
        diagnostics.warning("other-site", message, said.span, hint)
        return said.text
    return site
