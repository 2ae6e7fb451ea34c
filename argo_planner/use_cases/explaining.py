"""Explanation of missions in plain sentences."""

from enum import StrEnum

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script.write.reading import MissionReading, read_back
from argo_env.planning.opening import OpenedSite
from argo_planner.use_cases.importing import ImportedMission


class ExplanationFormat(StrEnum):
    """Format of a written explanation."""

    TEXT = "text"
    JSON = "json"


def explain_mission(imported: ImportedMission, site: OpenedSite) -> MissionReading:
    """Return sentences that say how Argo understood a mission.

    Raises:
        DiagnosticError: A script can't express parts of the mission; the diagnostics name them.
    """
    try:
        return read_back(imported.mission, site.catalog, imported.warnings, imported.source_name)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None


def format_explanation(
    explanation: MissionReading, format: ExplanationFormat = ExplanationFormat.TEXT
) -> str:
    """Return an explanation as text for people, which is also a script, or as JSON."""
    if format is ExplanationFormat.JSON:
        return explanation.model_dump_json(indent=2) + "\n"
    return explanation.text
