"""The runs of tasks in blocks, each visit to a group with its rounds and what lies between; and
what the robot waited for."""

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from argo_compiler.hfsm import Composite, Hfsm
from argo_compiler.hfsm.conditions import conditions_text
from argo_compiler.hfsm.model import task_id
from argo_compiler.il import Condition
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_env.formatting import clock
from argo_env.run.record import GivenValue, Interruption, Reading, RoundRun, RunRecord, TaskRun

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


@dataclass(frozen=True)
class Block:
    """Consecutive runs of tasks. `group` is the outermost group that they belong to, if any."""

    group: str | None
    rounds: tuple[tuple[TaskRun, ...], ...]
    """the runs of each round; outside of groups there is one"""

    @property
    def runs(self) -> tuple[TaskRun, ...]:
        return tuple(run for part in self.rounds for run in part)

    @property
    def start(self) -> float:
        """s."""
        return self.rounds[0][0].start

    @property
    def end(self) -> float:
        """s."""
        return self.rounds[-1][-1].end


def blocks(record: RunRecord) -> tuple[Block, ...]:
    """The runs of a record in their order.

    Where a group and another one in it begin and end with the same tasks, the rounds of the inner
    one are counted. The drive of a reaction belongs to the visit that it interrupts.
    """
    hfsm = record.hfsm
    outermost = _outermost(hfsm)
    groups: list[Composite | None] = []
    for run in record.tasks:
        around = groups[-1] if groups and run.task in RESERVED_NAMES else None
        groups.append(outermost.get(task_id(run.task), around))
    result = []
    pairs = zip(groups, record.tasks, strict=True)
    for id, part in groupby(pairs, key=lambda pair: _id_of(pair[0])):
        visit = tuple(run for _, run in part)
        group = outermost.get(task_id(visit[0].task))
        if id is None or group is None:
            result.append(Block(None, (visit,)))
            continue
        alike = _alike(hfsm, group)
        begins = [r.began for r in record.rounds if r.group in alike and r.began is not None]
        numbers = [bisect_right(begins, run.start) for run in visit]
        rounds = [
            tuple(run for k, run in zip(numbers, visit, strict=True) if k == number)
            for number in dict.fromkeys(numbers)
        ]
        result.append(Block(group.name, tuple(rounds)))
    return tuple(result)


def with_waits(
    found: Sequence[Block], waits: Sequence[Wait]
) -> tuple[tuple[tuple[TaskRun | Wait, ...], ...], ...]:
    """For each block its rounds, with the waits in them: all by the times of their beginnings."""
    begins = [part[0].start for block in found for part in block.rounds]
    spans = pairwise([-math.inf, *begins[1:], math.inf])
    result = []
    for block in found:
        rounds = []
        for part, (since, until) in zip(block.rounds, spans, strict=False):
            inside = [wait for wait in waits if since <= wait.start < until]
            rows: list[TaskRun | Wait] = [*part, *inside]
            rounds.append(tuple(sorted(rows, key=lambda row: row.start)))
        result.append(tuple(rounds))
    return tuple(result)


def with_readings(record: RunRecord) -> list[tuple[RoundRun, str]]:
    """The rounds whose beginnings are planned or whose end is decided, each with the values, as
    they were at its end, that its group repeats until."""
    until = {c.name: c.repeat.until for c in record.hfsm.composites[1:] if c.repeat}
    return [
        (one, _values(record, until[one.group], one.ended) if one.ended else "")
        for one in record.rounds
        if one.due is not None or until[one.group]
    ]


def repeat_rules(record: RunRecord) -> list[str]:
    """What the plan says of these rounds, for each of their groups a sentence."""
    rules = []
    for group in record.hfsm.composites[1:]:
        repeat = group.repeat
        if repeat is None or not (repeat.every or repeat.until):
            continue
        said = [f"a round every {repeat.every:g} s"] if repeat.every else []
        said += [f"until {conditions_text(repeat.until)}"] if repeat.until else []
        said += [f"{repeat.count} rounds at most"] if repeat.count else []
        said += [f"for {repeat.duration:g} s at most"] if repeat.duration else []
        rules.append(f"{group.name}: {', '.join(said)}.")
    return rules


def _values(record: RunRecord, until: Sequence[Condition], at: float) -> str:
    """The last reading before the time `at` (s) of each checkpoint that the conditions look at: a
    measurement that failed takes the place of the value before it (rule C3)."""
    said = []
    for id in dict.fromkeys(condition.object_id for condition in until):
        told: list[Reading | GivenValue] = [*record.readings, *record.given_values]
        before = [one for one in told if str(one.checkpoint) == id and one.t <= at]
        last = max(before, key=lambda one: one.t, default=None)
        text = "no value" if last is None else f"{last.value:.4g} {last.unit} at {clock(last.t)}"
        failed = [
            t.end for t in record.tasks if t.object_id == id and t.outcome_in_words == "failed"
        ]
        since = max((end for end in failed if end <= at), default=-math.inf)
        if since > (-math.inf if last is None else last.t):
            text = f"failed at {clock(since)}"
        said.append(f"#{id}: {text}")
    return ", ".join(said)


def _alike(hfsm: Hfsm, group: Composite) -> frozenset[str]:
    """The names of the group and of those in it that begin and end with the same tasks."""
    composites = {c.id: c for c in hfsm.composites}
    found = {group.name}
    while (inner := composites.get(group.children[-1])) and len(group.children) == 1:
        group = inner
        found.add(group.name)
    return frozenset(found)


def _id_of(group: Composite | None) -> str | None:
    return None if group is None else group.id


def _outermost(hfsm: Hfsm) -> dict[str, Composite]:
    """The outermost group that each leaf lies in."""
    top: dict[str, Composite] = {}
    for group in hfsm.composites[1:]:
        top[group.id] = top.get(group.parent or "", group)
    return {leaf.id: top[leaf.parent] for leaf in hfsm.leaves if leaf.parent in top}
