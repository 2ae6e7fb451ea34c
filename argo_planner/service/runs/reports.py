"""Why a run has no report, and what there is instead."""

from pathlib import Path

from argo_compiler.base.errors import NotFound
from argo_planner.service.runs.state import RunState, RunStatus


def missing_report(state: RunState, file: str, journal: Path | None, making: bool) -> NotFound:
    """Says it. `journal` is the last one of the run; `making`: its process is still there."""
    entries = f"what has happened is in /api/runs/{state.id}/entries"
    if state.status is not RunStatus.ENDED:
        why = f"it is {state.status}, and the report is made when it has ended; {entries} so far"
    elif making:
        why = "it has just ended, and the report is being made: ask again in a moment"
    elif journal is None or state.entries == 0:
        why = f"it ended before anything had happened ({state.problem}): begin another one"
    else:
        why = (
            f"its process ended before the report was made, or it was deleted; {entries}, and "
            f"`argo resume {journal} --report FOLDER`, on the machine of the service, makes it"
        )
    return NotFound(f"run {state.id} has no {file}: {why}")
