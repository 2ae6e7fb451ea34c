"""Missions as scripts, and in the formats of other tools."""

from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.base.errors import NotFound
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export import EXPORTERS, Exporter
from argo_compiler.hfsm import lower
from argo_compiler.isar import to_isar
from argo_compiler.script import format_script
from argo_env.planning.opening import OpenedSite
from argo_env.planning.reading_places import inspection_views
from argo_planner.use_cases.importing import ImportedMission

FORMATS = (*EXPORTERS, "isar")
"""The names of all formats."""


@dataclass(frozen=True)
class ExportedMission:
    """What was written of a mission."""

    content: str | bytes | Mapping[str, bytes]
    """a file as text or bytes, or the files of a folder by their paths in it"""
    description: str
    """of the format"""


def exporters(site: OpenedSite) -> dict[str, Exporter]:
    """By the names of the formats: the compiler's, and isar's, which needs the site."""
    isar = Exporter(
        "isar mission definition",
        (".json",),
        lambda mission, hfsm: to_isar(mission, hfsm, inspection_views(mission, site.navigator)),
    )
    return EXPORTERS | {"isar": isar}


def require_format(name: str) -> None:
    """Raises NotFound if there is no such format."""
    if name not in FORMATS:
        raise NotFound(f"{name}: there is no such format; choose from {', '.join(FORMATS)}")


def is_folder(format: str) -> bool:
    """Whether the format is a folder of files. Raises NotFound if there is no such format."""
    require_format(format)
    return format in EXPORTERS and not EXPORTERS[format].suffixes


def export_mission(imported: ImportedMission, site: OpenedSite, format: str) -> ExportedMission:
    """Writes a mission in that format.

    Raises NotFound if there is no such format, and DiagnosticError with all that it can't say.
    """
    require_format(format)
    exporter = exporters(site)[format]
    machine = lower(imported.mission, source_name=imported.source_name)
    try:
        content = exporter.export(imported.mission, machine)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None
    return ExportedMission(content, exporter.description)


def as_script(imported: ImportedMission, site: OpenedSite) -> str:
    """The mission as a script, in one canonical form; importing that gives the same mission.

    Raises DiagnosticError, with all that no script can say.
    """
    try:
        return format_script(imported.mission, site.catalog)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None
