"""What becomes of a run whose process is gone, or could not begin."""

from collections.abc import Sequence
from dataclasses import dataclass

from argo_planner.service.runs.requests import RequestProgress, RequestState
from argo_planner.service.runs.state import RunState, RunStatus


@dataclass(frozen=True)
class LeftBehind:
    """How a run stands without its process, and what came of what was asked of it."""

    state: RunState
    settled: tuple[RequestState, ...]
    stop: RequestState | None
    """somebody has asked for it to stop, and another process is to do that"""


def left_behind(
    state: RunState,
    pending: Sequence[RequestState],
    problem: str,
    *,
    begun: bool,
    ended: bool,
    may_stop: bool,
) -> LeftBehind:
    """`problem` is why the process is gone; whether the run had `begun`, and `ended`, is what its
    journals say. Another process may be begun to stop it, unless that was tried (`may_stop`)."""
    stop = next((one for one in pending if one.kind == "stop"), None)
    if ended or state.status is RunStatus.ENDED:
        status, why = RunStatus.ENDED, state.problem
    elif not begun or (stop is not None and not may_stop):
        status, why = RunStatus.ENDED, problem
    else:
        status, why = RunStatus.INTERRUPTED, problem
    over = status is RunStatus.ENDED
    settled = []
    for one in pending:
        if one.kind == "stop" and over:
            done = {"progress": RequestProgress.CONFIRMED, "reason": why}
        else:
            done = {"progress": RequestProgress.FAILED, "reason": why or "the run has ended before"}
        if over or one is not stop:
            settled.append(one.model_copy(update=done))
    update = {"status": status, "problem": why, "moving": False, "task": None, "by_hand": False}
    return LeftBehind(state.model_copy(update=update), tuple(settled), None if over else stop)
