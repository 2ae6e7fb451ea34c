"""`argo export`: a mission in the format of another tool."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.errors import ArgoError
from argo_compiler.export import EXPORTERS, Exporter
from argo_compiler.hfsm import lower
from argo_env.files.folders import make_folder
from argo_planner.exporters import exporters
from argo_planner.loading import (
    keep_input,
    load_mission,
    load_navigator,
    write_text,
)
from argo_planner.options import EndArea, SiteOption, Source, StartArea

_FORMATS = ", ".join([*EXPORTERS, "isar"])


def export_mission(
    source: Source,
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help=_FORMATS)],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="the file to write, or the folder of files")
    ],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Write a mission in the format of another tool."""
    keep_input(source, output)
    navigator = load_navigator(site)
    exporter = _exporter(exporters(navigator), to)
    mission, _ = load_mission(source, navigator, start_area, end_area)
    machine = lower(mission, source_name=str(source))
    try:
        exported = exporter.export(mission, machine)
    except DiagnosticError as error:
        raise DiagnosticError(str(source), error.diagnostics) from None
    if isinstance(exported, str):
        write_text(output, exported)
    elif isinstance(exported, bytes):
        _write_bytes(output, exported)
    else:
        _write_folder(output, exported)
    Console(highlight=False).print(f"{escape(str(output))}: {exporter.description}", soft_wrap=True)


def _exporter(known: Mapping[str, Exporter], name: str) -> Exporter:
    if name not in known:
        raise ArgoError(f"--to {name}: there is no such format; choose from {', '.join(known)}")
    return known[name]


def _write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    if folder.exists() and not folder.is_dir():
        raise ArgoError(f"{folder}: this format is a folder of files, and there is a file already")
    for path, content in files.items():
        make_folder((folder / path).parent)
        _write_bytes(folder / path, content)


def _write_bytes(path: Path, content: bytes) -> None:
    try:
        path.write_bytes(content)
    except OSError as error:
        raise ArgoError(f"{path}: can't be written: {error.strerror}") from error
