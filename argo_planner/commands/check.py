"""`argo check`: all that is wrong or odd about a mission, without running it."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.analysis import Travel, analyse
from argo_compiler.catalog import Catalog
from argo_compiler.checks import check
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    Severity,
    by_place,
    has_errors,
    summary,
    to_json,
    to_sarif,
    to_text,
)
from argo_compiler.errors import ArgoError
from argo_env.planning.catalog import make_catalog
from argo_env.planning.travel import SiteTravel
from argo_planner.loading import (
    is_mission_file,
    keep_input,
    load_navigator,
    load_source,
    refuse_areas,
    write_text,
)
from argo_planner.options import EndArea, SiteOption, Source, StartArea


class Format(StrEnum):
    """How diagnostics are written."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"


def check_mission(
    source: Source,
    site: SiteOption = "umad",
    format: Annotated[
        Format, typer.Option("--format", help="for people, programs or code hosts")
    ] = Format.TEXT,
    strict: Annotated[
        bool, typer.Option("--strict", help="exit with status 1 if there are warnings")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="a file to write the findings to")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Say all that is wrong or odd about a mission; exits with status 2 if there are errors."""
    if output:
        keep_input(source, output)
    if is_mission_file(source):
        refuse_areas(source, start_area, end_area)
    navigator = load_navigator(site)
    diagnostics = find_all(
        source, make_catalog(navigator), start_area, end_area, SiteTravel(navigator)
    )
    written = _WRITERS[format](diagnostics, str(source))
    count = f"{source}: {summary(diagnostics)}"
    if output:
        write_text(output, written + "\n")
        print(count)
    else:
        print(written)
    if has_errors(diagnostics):
        raise typer.Exit(2)
    if diagnostics and strict:
        raise typer.Exit(1)


def find_all(
    source: Path,
    catalog: Catalog,
    start_area: int | None = None,
    end_area: int | None = None,
    travel: Travel | None = None,
) -> tuple[Diagnostic, ...]:
    """The diagnostics of every stage that the mission gets through, by place."""
    try:
        loaded = load_source(source, catalog, start_area, end_area)
    except DiagnosticError as error:
        return error.diagnostics
    except ArgoError as error:
        return (Diagnostic(code="script.unreadable", severity=Severity.ERROR, message=str(error)),)
    found = check(loaded.mission, catalog)
    if not has_errors(found):
        found += analyse(loaded.mission, catalog, travel).diagnostics
    return by_place((*loaded.diagnostics, *loaded.placed(found)))


def _to_text(diagnostics: tuple[Diagnostic, ...], source_name: str) -> str:
    text = to_text(diagnostics, source_name)
    # Of several diagnostics it says by itself how many there are.
    return (
        text if len(diagnostics) > 1 else f"{text}\n{source_name}: {summary(diagnostics)}".lstrip()
    )


_WRITERS = {Format.TEXT: _to_text, Format.JSON: to_json, Format.SARIF: to_sarif}
