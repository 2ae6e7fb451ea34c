"""Quantities of evaluations: properties of a run, such as success, that are counted as rates.

To add a quantity, list it here and add its texts: for reports in `report/sections.py`, for the page
in `argo_planner/page/src/texts/evaluate.ts`, and for the terminal, whose tables have columns of
their own, in `argo_planner/terminal/evaluation_tables.py`. `estimates/` has the intervals. Numbers,
such as the duration of a run, are fields of `row.py`; `control_variates.py` has the numbers that
cheap runs help to estimate.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_env.evaluation.row import RunRow


def _all_faults_found(row: "RunRow") -> bool | None:
    if not row.detections:
        return None
    return all(detection.delay is not None for detection in row.detections)


QUANTITIES: dict[str, Callable[["RunRow"], bool | None]] = {
    "success": lambda row: row.success,
    "contact": lambda row: row.contacts > 0,
    "mishap": lambda row: row.mishaps > 0,
    "late": lambda row: row.limit is not None and (row.duration or 0.0) > row.limit,
    "detected": _all_faults_found,
    "false alarm": lambda row: row.false_alarms > 0,
}
"""Quantities by name, which requirements can use.

Each function takes a run that was carried out and returns whether the run has the property. It
returns None if the question makes no sense, such as whether all faults were found in a run without
faults; such a run does not count.
"""
