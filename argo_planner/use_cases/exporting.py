"""Export of missions as scripts and to the formats of other tools."""

from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export import EXPORTERS, ExportInput
from argo_compiler.hfsm import lower
from argo_compiler.script import format_script
from argo_env.planning.inspection_views import inspection_views_by_object_id
from argo_env.planning.opening import OpenedSite
from argo_planner.use_cases.importing import ImportedMission


@dataclass(frozen=True)
class ExportedMission:
    """An exported mission."""

    content: str | bytes | Mapping[str, bytes]
    """a file as text or bytes, or the files of a folder by their paths in it"""
    description: str
    """name of the format for people"""
    suffix: str
    """usual ending of the file's name; empty for a folder"""


def export_mission(imported: ImportedMission, site: OpenedSite, format: str) -> ExportedMission:
    """Convert a mission to the format with this name; write nothing.

    Raises:
        NotFound: There is no such format.
        Unavailable: The exporter of an installed package can't be used, or has failed.
        DiagnosticError: The format can't express parts of the mission; the diagnostics name them.
    """
    exporter = EXPORTERS[format]
    given = ExportInput(
        imported.mission,
        lower(imported.mission, source_name=imported.source_name),
        lambda: inspection_views_by_object_id(imported.mission, site.navigator),
    )
    try:
        content = exporter.export(given)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None
    return ExportedMission(content, exporter.description, next(iter(exporter.suffixes), ""))


def to_script(imported: ImportedMission, site: OpenedSite) -> str:
    """Return the mission as a script in a standard form; importing it gives the same mission.

    Raises:
        DiagnosticError: A script can't express parts of the mission; the diagnostics name them.
    """
    try:
        return format_script(imported.mission, site.catalog)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None
