"""One run of an evaluation, in whatever process."""

import os
import threading
import traceback
from dataclasses import dataclass

from argo_compiler.base.errors import ArgoError
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.row import RunOutcome, RunRow, row_of, row_without_end
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec

TOOK_TOO_LONG = 70
"""exit code of a worker whose run took longer than it may"""


@dataclass(frozen=True)
class WorkOrder:
    """What a worker is told: a run, and the key that its row has."""

    key: str
    case: EvaluationCase
    spec: RunSpec
    world: dict[str, float]
    """what was drawn for its world"""
    drawn: str = ""
    """what the faults are called that were"""
    limit: float | None = None
    """s of wall time that it may take; then its process ends, and that is its reason"""


def carry_out(order: WorkOrder, site: OpenedSite | None = None) -> RunRow:
    """Makes the run, on the site that it names unless one is given, and its row. What goes wrong in
    the simulator is an outcome as well: one of many thousand runs must not end them all."""
    row = _row(order, site)
    return row.model_copy(update={"world": order.world, "drawn": order.drawn})


def _row(order: WorkOrder, site: OpenedSite | None) -> RunRow:
    watchdog = None
    if order.limit is not None:
        watchdog = threading.Timer(order.limit, os._exit, (TOOK_TOO_LONG,))
        watchdog.daemon = True
        watchdog.start()
    try:
        opened = site or open_site(order.spec.site, load_robot(order.spec.robot))
        record = simulate(order.spec, opened)
        return row_of(order.key, order.case, order.spec, record, opened.site)
    except ArgoError as error:
        return row_without_end(order.key, order.case, order.spec, RunOutcome.ERROR, str(error))
    except Exception as error:  # told in the row, with its place
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{os.path.basename(frame.filename)}, line {frame.lineno}"
        reason = f"{type(error).__name__}: {error} ({place})"
        return row_without_end(order.key, order.case, order.spec, RunOutcome.ERROR, reason)
    finally:
        if watchdog is not None:
            watchdog.cancel()
