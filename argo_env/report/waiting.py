"""What the robot waited for: planned waits, and what of pauses and reactions it stood still."""

from collections.abc import Iterator
from dataclasses import dataclass

from argo_env.formatting import clock
from argo_env.run.record import Interruption, RunRecord

MOMENT = 0.5
"""s, up to which standing still is no waiting"""


@dataclass(frozen=True)
class Wait:
    """The robot stood still from `start` to `end` (s)."""

    what: str
    """it waited for, and why"""
    start: float
    end: float
    outcome: str
    """how it ended, in words"""


def waits(record: RunRecord) -> tuple[Wait, ...]:
    """When the robot stood still: at WAITs, for time windows and rounds, in pauses and reactions;
    in the order of time."""
    found = [*_planned(record), *_interrupted(record)]
    return tuple(sorted(found, key=lambda wait: wait.start))


def _planned(record: RunRecord) -> Iterator[Wait]:
    """What the mission itself waits for."""
    end = record.result.duration
    for wait in record.waits:
        outcome = f"failed: {wait.failure}" if wait.failure else _ended(wait.ended)
        yield Wait(f"{wait.what} ({wait.task})", wait.start, wait.end, outcome)
    for run in record.tasks:
        if run.early is not None:
            what = f"the time window ({run.task})"
            yield Wait(what, *run.early, _ended(run.early[1] < end))
    for each in record.rounds:
        until = min(filter(None, (each.began, each.ended, end)))
        if each.due is not None and each.due > each.since and until - each.since >= MOMENT:
            yield Wait(f"the next round ({each.group})", each.since, until, _ended(until < end))


def _interrupted(record: RunRecord) -> list[Wait]:
    """The parts of pauses and reactions in which it stood still."""
    found = []
    until = {reaction.event: reaction.until for reaction in record.mission.reactions}
    before: Interruption | None = None
    for each in record.interruptions:
        runs = [t.end for t in record.tasks if t.start < each.end and t.end > each.start]
        since = max([each.start, *runs])
        # A run that is stopped as soon as nothing more can come has waited no time.
        if each.end - since >= MOMENT or (record.result.outcome is None and each is _last(record)):
            awaited = until.get(each.event) if each.event else None
            cause = each.cause
            if each.event is None and before and before.event and before.end == each.start:
                cause = before.cause  # which has ended in this pause
            what = f"{awaited.replace('_', ' ') if awaited else 'a person'} ({cause})"
            outcome = _ended(each.end < record.result.duration)
            if each.limit_over:
                outcome = f"the limit of the hold was over at {clock(each.end)}"
            found.append(Wait(what, since, each.end, outcome))
        before = each
    return found


def _ended(over: bool) -> str:
    return "over" if over else "still waiting at the end"


def _last(record: RunRecord) -> Interruption | None:
    """The interruption that went on when the run was stopped."""
    last = record.interruptions[-1]
    return last if last.end >= record.result.duration else None
