"""Missions said back in plain sentences."""

from enum import StrEnum

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script.write.reading import MissionReading, read_back
from argo_env.planning.opening import OpenedSite
from argo_planner.use_cases.importing import ImportedMission


class ReadingFormat(StrEnum):
    """How a reading is written."""

    TEXT = "text"
    JSON = "json"


def reading_of(imported: ImportedMission, site: OpenedSite) -> MissionReading:
    """What was understood of a mission. Raises DiagnosticError, with all that no script can say."""
    try:
        return read_back(imported.mission, site.catalog, imported.warnings, imported.source_name)
    except DiagnosticError as error:
        raise DiagnosticError(imported.source_name, error.diagnostics) from None


def write_reading(reading: MissionReading, format: ReadingFormat = ReadingFormat.TEXT) -> str:
    """The reading as text for people, which is a script itself, or as JSON."""
    if format is ReadingFormat.JSON:
        return reading.model_dump_json(indent=2) + "\n"
    return reading.text
