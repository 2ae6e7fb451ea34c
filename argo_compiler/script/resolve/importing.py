"""Syntax tree to mission, and the whole way from text to mission in one call."""

from collections.abc import Sequence

from argo_compiler.catalog import Catalog
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.garbage_collector import collector_held
from argo_compiler.il import Mission
from argo_compiler.model import Model
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.protocol import protocol_mission
from argo_compiler.script.resolve.sheet import sheet_mission
from argo_compiler.script.syntax.nodes import ProtocolStep, Script, Sheet, SheetStep
from argo_compiler.script.syntax.parsing import parse
from argo_compiler.script.syntax.source import Diagnostics, Source
from argo_compiler.script.syntax.vocabulary import catalog_words


class Resolved(Model):
    """A script's mission, and the warnings that were met on the way."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...] = ()


@collector_held()
def resolve(
    script: Script, catalog: Catalog, start_area: int | None = None, end_area: int | None = None
) -> Resolved:
    """The mission that the script asks for on the catalogue's site.

    `start_area` and `end_area` are what the preparation chose where the script leaves it open.
    Raises DiagnosticError with all errors and warnings, those of parsing among them, sorted by
    place.
    """
    diagnostics = Diagnostics(
        Source(script.source_text, script.source_name), list(script.diagnostics)
    )
    if not diagnostics.errors:
        _check_numbering(script.steps, diagnostics)
    lookup = Lookup(catalog, diagnostics)
    if isinstance(script, Sheet):
        mission = sheet_mission(script, lookup, diagnostics, start_area, end_area)
    else:
        mission = protocol_mission(script, lookup, diagnostics, start_area, end_area)
    if mission is None:
        raise DiagnosticError(script.source_name, diagnostics.by_place())
    return Resolved(mission=mission, diagnostics=diagnostics.by_place())


@collector_held()
def import_script(
    text: str,
    catalog: Catalog,
    *,
    source_name: str = "script",
    start_area: int | None = None,
    end_area: int | None = None,
) -> Resolved:
    """The mission of the script `text`; see `parse` and `resolve`, whose errors it raises."""
    script = parse(text, catalog_words(catalog), source_name)
    return resolve(script, catalog, start_area, end_area)


def _check_numbering(steps: Sequence[SheetStep | ProtocolStep], diagnostics: Diagnostics) -> None:
    """Warns where the steps' numbers are not one after the other: a line may have been lost."""
    expected = 1
    for step in steps:
        if step.number is None:
            continue
        if step.number != expected:
            message = f"step {step.number} stands where step {expected} would be"
            hint = "is a line missing, or in the wrong place?"
            diagnostics.warning("step-number", message, step.span, hint)
        expected = step.number + 1
