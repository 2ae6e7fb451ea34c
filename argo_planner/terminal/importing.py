"""Missions as the commands take them: read from a file, with their warnings shown."""

import sys

from argo_compiler.diagnostics import DiagnosticError, to_text
from argo_env.planning.opening import OpenedSite
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.terminal.words import with_options
from argo_planner.use_cases.explaining import reading_of, write_reading
from argo_planner.use_cases.importing import ImportedMission, Upload, import_mission


def import_shown(
    upload: Upload, site: OpenedSite, start_area: int | None, end_area: int | None
) -> ImportedMission:
    """The mission of an upload. Warnings are shown. Raises ArgoError as `import_mission` does."""
    imported = import_mission(upload, site, start_area, end_area)
    if imported.warnings and not is_quiet():
        print(to_text(with_options(imported.warnings), upload.name), file=sys.stderr)
    return imported


def show_reading(imported: ImportedMission, site: OpenedSite) -> None:
    """What was understood of a mission, in plain sentences; what can't be said so is named."""
    try:
        print(write_reading(reading_of(imported, site)), end="")
    except DiagnosticError as error:
        print(to_text(error.diagnostics, imported.source_name), file=sys.stderr)
