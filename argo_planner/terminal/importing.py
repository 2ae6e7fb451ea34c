"""Import of missions with their warnings on the terminal."""

import sys

from argo_compiler.diagnostics import DiagnosticError
from argo_env.planning.opening import OpenedSite
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.terminal.words import diagnostics_text
from argo_planner.use_cases.explaining import explain_mission, format_explanation
from argo_planner.use_cases.importing import ImportedMission, Upload, import_mission


def import_and_warn(
    upload: Upload, site: OpenedSite, start_area: int | None, end_area: int | None
) -> ImportedMission:
    """Import a mission and print its warnings; raise what `import_mission` raises."""
    imported = import_mission(upload, site, start_area, end_area)
    if imported.warnings and not is_quiet():
        print(diagnostics_text(imported.warnings, upload.name), file=sys.stderr)
    return imported


def show_explanation(imported: ImportedMission, site: OpenedSite) -> None:
    """Print a mission in plain sentences, or diagnostics for what no script can express."""
    try:
        print(format_explanation(explain_mission(imported, site)), end="")
    except DiagnosticError as error:
        print(diagnostics_text(error.diagnostics, imported.source_name), file=sys.stderr)
