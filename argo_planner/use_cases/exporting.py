"""Export of missions as scripts and to the formats of other tools."""

from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.base.errors import NotFound
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export import EXPORTERS, Exporter
from argo_compiler.hfsm import lower
from argo_compiler.isar import to_isar
from argo_compiler.script import format_script
from argo_env.planning.inspection_views import inspection_views_by_object_id
from argo_env.planning.opening import OpenedSite
from argo_planner.use_cases.importing import ImportedMission

FORMATS = (*EXPORTERS, "isar")
"""names of all formats"""


@dataclass(frozen=True)
class ExportedMission:
    """An exported mission."""

    content: str | bytes | Mapping[str, bytes]
    """a file as text or bytes, or the files of a folder by their paths in it"""
    description: str
    """name of the format for people"""


def exporters(site: OpenedSite) -> dict[str, Exporter]:
    """Return the exporters by format: those of the compiler, and isar's, which needs the site."""
    isar = Exporter(
        "isar mission definition",
        (".json",),
        lambda mission, hfsm: to_isar(
            mission, hfsm, inspection_views_by_object_id(mission, site.navigator)
        ),
    )
    return EXPORTERS | {"isar": isar}


def require_format(name: str) -> None:
    """Raise NotFound if there is no such format."""
    if name not in FORMATS:
        raise NotFound(f"{name}: there is no such format; choose from {', '.join(FORMATS)}")


def is_folder_format(format: str) -> bool:
    """Return True if the format is a folder of files; raise NotFound if there is no such format."""
    require_format(format)
    return format in EXPORTERS and not EXPORTERS[format].suffixes


def export_mission(imported: ImportedMission, site: OpenedSite, format: str) -> ExportedMission:
    """Convert a mission to the format with this name; write nothing.

    Raises:
        NotFound: There is no such format.
        DiagnosticError: The format can't express parts of the mission; the diagnostics name them.
    """
    require_format(format)
    exporter = exporters(site)[format]
    machine = lower(imported.mission, source_name=imported.source_name)
    try:
        content = exporter.export(imported.mission, machine)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None
    return ExportedMission(content, exporter.description)


def to_script(imported: ImportedMission, site: OpenedSite) -> str:
    """Return the mission as a script in a standard form; importing it gives the same mission.

    Raises:
        DiagnosticError: A script can't express parts of the mission; the diagnostics name them.
    """
    try:
        return format_script(imported.mission, site.catalog)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None
