"""Diagnostics on time windows that close too early, and on time limits that are too short."""

import math
from collections.abc import Iterator

from argo_compiler.analysis.bounds import MissionBounds
from argo_compiler.analysis.study import Study
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.quantity_text import exceeding_duration_text, limit_text
from argo_compiler.diagnostics import Diagnostic

_TOLERANCE = 1e-6  # s, as sums of floats are not exact


def diagnose_windows(study: Study, bounds: MissionBounds) -> Iterator[Diagnostic]:
    """Yield diagnostics on tasks that end too late for their window on some or all paths.

    The times are those of `bounds`: planned travel times and actions, without failures.
    """
    for leaf, flow in enumerate(study.flow.leaves):
        window = flow.leaf.task.window
        if window is None or window.latest is None or not study.nominal.is_reached(leaf):
            continue
        end = bounds.task_end_bounds[leaf]
        name, latest = study.name(leaf), limit_text(window.latest)
        if end.soonest > window.latest + _TOLERANCE:
            soonest = ""
            if math.isfinite(end.soonest):
                ends = exceeding_duration_text(end.soonest, window.latest)
                soonest = Message(": it ends after {ends} at the soonest", ends=ends)
            yield study.diagnostic(
                "window-missed" if window.hard else "window-late",
                Message(
                    "if nothing fails, no execution path is in time for task '{name}', whose "
                    "window closes {latest} after the mission's start{soonest}",
                    name=name,
                    latest=latest,
                    soonest=soonest,
                ),
                "do it earlier, or let its window close later",
                leaf,
            )
        elif end.latest > window.latest + _TOLERANCE and leaf not in study.leaves_until_window:
            yield study.diagnostic(
                "window-maybe-missed",
                Message(
                    "task '{name}' may come too late: its window closes {latest} after the "
                    "mission's start, and some execution path may take longer",
                    name=name,
                    latest=latest,
                ),
                Message("do it earlier, or let its window close later")
                + (
                    ""
                    if not window.hard
                    else Message(", and give the next task with missed_target")
                ),
                leaf,
            )


def diagnose_task_time_limits(study: Study) -> Iterator[Diagnostic]:
    """Yield diagnostics on tasks that always take longer than their time limit if nothing fails."""
    for leaf, taken in sorted(study.costs.too_slow.items()):
        limit = study.leaf_task(leaf).time_limit
        assert limit is not None
        if study.leaf_task(leaf).retries:
            continue  # each attempt continues from where the previous one stopped
        yield study.diagnostic(
            "time-limit",
            Message(
                "task '{task}' takes at least {exceeding_duration} as planned, longer than "
                "its time limit of {limit}, {consequence}",
                task=study.name(leaf),
                exceeding_duration=exceeding_duration_text(taken, limit),
                limit=limit_text(limit),
                consequence=_consequence(study, leaf),
            ),
            "give it more time",
            leaf,
        )


def _consequence(study: Study, leaf: int) -> str:
    """Return what follows as a task takes longer than its time limit as planned."""
    if leaf not in study.certain_failures:
        return Message("so it can't be done as planned")
    ended = [
        tuple(filter(study.flow.is_leaf, nodes))
        for nodes in study.trap_nodes
        if leaf in nodes and any(n not in nodes for n in study.planned_successors[leaf])
    ]
    endless = [Message("the loop of {tasks}", tasks=study.tasks_text(leaves)) for leaves in ended]
    end = study.flow.end_node
    if not study.nominal.is_reached(end) and study.reached_as_planned[end]:
        endless.append(Message("the mission"))
    without = (
        Message("; without a failure, {endless:and} would never end", endless=Listing(endless))
        if endless
        else ""
    )
    return Message("so it fails if nothing interrupts it{without}", without=without)
