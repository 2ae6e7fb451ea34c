"""Statistics of evaluations: what is counted of each run, such as successes.

A new one is listed here. Its words are in `report/sections.py`, for the page in
`argo_planner/page/src/texts/evaluate.ts`, and for the terminal, whose tables have columns of their
own, in `argo_planner/terminal/evaluation_tables.py`; how sure an estimate is, `estimates/` says.
Numbers, such as how long a run took, are fields of `row.py`; `controlled.py` has those that cheap
runs help to estimate.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_env.evaluation.row import RunRow


def _all_found(row: "RunRow") -> bool | None:
    if not row.detections:
        return None
    return all(one.delay is not None for one in row.detections)


QUANTITIES: dict[str, Callable[["RunRow"], bool | None]] = {
    "success": lambda row: row.success,
    "contact": lambda row: row.contacts > 0,
    "mishap": lambda row: row.mishaps > 0,
    "late": lambda row: row.limit is not None and (row.duration or 0.0) > row.limit,
    "detected": _all_found,
    "false alarm": lambda row: row.false_alarms > 0,
}
"""What can be required, by name: of a run that was carried out, whether it is so; None where that
makes no sense, as that all was found where nothing was wrong: such a run does not count."""
