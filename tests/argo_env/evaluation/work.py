"""Functions that workers call in tests of evaluations: runs that kill them, or are invented."""

import os
import signal

from argo_env.evaluation.row import RunOutcome, RunRow, make_empty_row
from argo_env.evaluation.runner import WorkOrder, execute_run


def invented(order: WorkOrder) -> RunRow:
    """Return an invented row, a failure in every seventh world; kill the worker in world 500."""
    if order.spec.seed == 500:
        os.kill(os.getpid(), signal.SIGKILL)
    outcome = RunOutcome.FAILURE if order.spec.seed % 7 == 3 else RunOutcome.SUCCESS
    row = make_empty_row(order.key, order.case, order.spec, outcome, "invented")
    return row.model_copy(update={"duration": 100.0 + order.spec.seed})


def poisoned(order: WorkOrder) -> RunRow:
    """Execute the run; in world 3 end the worker with exit code 7 instead."""
    if order.spec.seed == 3:
        os._exit(7)
    return execute_run(order)


def broken(order: WorkOrder) -> RunRow:
    raise RuntimeError(f"no run for {order.spec.seed}")
