"""Executions of tasks in blocks, one for each visit to a group or stretch between, and waits."""

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from argo_compiler.hfsm import Composite, Hfsm
from argo_compiler.hfsm.conditions import conjunction_text
from argo_compiler.hfsm.model import task_id
from argo_compiler.il import Condition
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_env.formatting import min_sec_text
from argo_env.run.record import GivenValue, Interruption, Reading, RoundRun, RunRecord, TaskRun

MOMENT = 0.5
"""s, longest standstill that does not count as a wait"""


@dataclass(frozen=True)
class Wait:
    """Wait of the robot, which stood still from `start` to `end` (s)."""

    what: str
    """what the robot waited for, with the task, group or cause"""
    start: float
    end: float
    outcome: str
    """end of the wait, in words"""


def all_waits(record: RunRecord) -> tuple[Wait, ...]:
    """Return all waits of a run, sorted by their start.

    They are those of WAIT tasks, those for time windows and rounds, and those in pauses and
    reactions.
    """
    unsorted = [*_planned(record), *_interrupted(record)]
    return tuple(sorted(unsorted, key=lambda wait: wait.start))


def _planned(record: RunRecord) -> Iterator[Wait]:
    """Yield the waits that the mission itself asks for."""
    end = record.result.duration
    for wait in record.waits:
        outcome = f"failed: {wait.failure}" if wait.failure else _ended(wait.ended)
        yield Wait(f"{wait.what} ({wait.task})", wait.start, wait.end, outcome)
    for run in record.tasks:
        if run.early is not None:
            what = f"the time window ({run.task})"
            yield Wait(what, *run.early, _ended(run.early[1] < end))
    for round_run in record.rounds:
        until = round_run.awaited_until(end)
        if (
            round_run.due is not None
            and round_run.due > round_run.since
            and until - round_run.since >= MOMENT
        ):
            yield Wait(
                f"the next round ({round_run.group})", round_run.since, until, _ended(until < end)
            )


def _interrupted(record: RunRecord) -> list[Wait]:
    """Return the waits in pauses and reactions: the time after the last action in each of them.

    Waits shorter than MOMENT are left out, except for one that lasted until a run without an
    outcome was stopped.
    """
    waits = []
    until = {reaction.event: reaction.until for reaction in record.mission.reactions}
    previous: Interruption | None = None
    for interruption in record.interruptions:
        runs = [
            t.end for t in record.tasks if t.start < interruption.end and t.end > interruption.start
        ]
        since = max([interruption.start, *runs])
        # A run that is stopped as soon as no event can occur any more has waited for no time.
        if interruption.end - since >= MOMENT or (
            record.result.outcome is None and interruption is _last(record)
        ):
            awaited = until.get(interruption.event) if interruption.event else None
            cause = interruption.cause
            if (
                interruption.event is None
                and previous
                and previous.event
                and previous.end == interruption.start
            ):
                cause = previous.cause  # of the reaction that has ended in this pause
            what = f"{awaited.replace('_', ' ') if awaited else 'a person'} ({cause})"
            outcome = _ended(interruption.end < record.result.duration)
            if interruption.limit_over:
                outcome = f"the limit of the hold was over at {min_sec_text(interruption.end)}"
            waits.append(Wait(what, since, interruption.end, outcome))
        previous = interruption
    return waits


def _ended(over: bool) -> str:
    return "over" if over else "still waiting at the end"


def _last(record: RunRecord) -> Interruption | None:
    """Return the interruption that lasted until the run was stopped; None if there is none."""
    last = record.interruptions[-1]
    return last if last.end >= record.result.duration else None


@dataclass(frozen=True)
class Block:
    """Consecutive task runs in the same outermost group, or outside of groups (`group` None)."""

    group: str | None
    rounds: tuple[tuple[TaskRun, ...], ...]
    """task runs of each round; outside of groups there is one round"""

    @property
    def runs(self) -> tuple[TaskRun, ...]:
        return tuple(run for part in self.rounds for run in part)

    @property
    def start(self) -> float:
        """Start of the block's first task, in s of the run's time."""
        return self.rounds[0][0].start

    @property
    def end(self) -> float:
        """End of the block's last task, in s of the run's time."""
        return self.rounds[-1][-1].end


def blocks_by_group(record: RunRecord) -> tuple[Block, ...]:
    """Split the task runs of a record into blocks, each in one outermost group or in none.

    The order of the task runs is kept. If a group consists of nothing but another group, each round
    of the inner one is a round of the block. A task that a reaction drives belongs to the block
    that the reaction interrupts.
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
        coextensive = _coextensive(hfsm, group)
        begins = [r.began for r in record.rounds if r.group in coextensive and r.began is not None]
        numbers = [bisect_right(begins, run.start) for run in visit]
        rounds = [
            tuple(run for k, run in zip(numbers, visit, strict=True) if k == number)
            for number in dict.fromkeys(numbers)
        ]
        result.append(Block(group.name, tuple(rounds)))
    return tuple(result)


def merge_waits(
    blocks: Sequence[Block], waits: Sequence[Wait]
) -> tuple[tuple[tuple[TaskRun | Wait, ...], ...], ...]:
    """Return each block as its rounds, and each round as its task runs and waits, sorted by start.

    A wait belongs to the last round that has begun by its start, or to the first round.
    """
    begins = [part[0].start for block in blocks for part in block.rounds]
    spans = pairwise([-math.inf, *begins[1:], math.inf])
    result = []
    for block in blocks:
        rounds = []
        for part, (since, until) in zip(block.rounds, spans, strict=False):
            inside = [wait for wait in waits if since <= wait.start < until]
            rows: list[TaskRun | Wait] = [*part, *inside]
            rounds.append(tuple(sorted(rows, key=lambda row: row.start)))
        result.append(tuple(rounds))
    return tuple(result)


def rounds_with_condition_values(record: RunRecord) -> list[tuple[RoundRun, str]]:
    """Return the rounds with a due time or an end condition, each with a text of the known values.

    The text has the last value up to the end of the round for each checkpoint in the condition that
    ends the repetition. It is empty if the round has not ended, or there is no such condition.
    """
    until = {c.name: c.repeat.until for c in record.hfsm.composites[1:] if c.repeat}
    return [
        (
            round_run,
            ""
            if round_run.ended is None
            else _values(record, until[round_run.group], round_run.ended),
        )
        for round_run in record.rounds
        if round_run.due is not None or until[round_run.group]
    ]


def repeat_rules(record: RunRecord) -> list[str]:
    """Return a sentence for each group with timed or conditional rounds: how often it repeats."""
    rules = []
    for group in record.hfsm.composites[1:]:
        repeat = group.repeat
        if repeat is None or not (repeat.every or repeat.until):
            continue
        limits = [f"a round every {repeat.every:g} s"] if repeat.every else []
        limits += [f"until {conjunction_text(repeat.until)}"] if repeat.until else []
        limits += [f"{repeat.count} rounds at most"] if repeat.count else []
        limits += [f"for {repeat.duration:g} s at most"] if repeat.duration else []
        rules.append(f"{group.name}: {', '.join(limits)}.")
    return rules


def _values(record: RunRecord, until: Sequence[Condition], at: float) -> str:
    """Return a text with the last value, up to the time `at` (s), of the conditions' checkpoints.

    A failed measurement replaces the value before it (rule C3).
    """
    texts = []
    for id in dict.fromkeys(condition.object_id for condition in until):
        values: list[Reading | GivenValue] = [*record.readings, *record.given_values]
        earlier = [value for value in values if str(value.checkpoint) == id and value.t <= at]
        last = max(earlier, key=lambda value: value.t, default=None)
        text = (
            "no value"
            if last is None
            else f"{last.value:.4g} {last.unit} at {min_sec_text(last.t)}"
        )
        failed = [
            t.end for t in record.tasks if t.object_id == id and t.outcome_in_words == "failed"
        ]
        since = max((end for end in failed if end <= at), default=-math.inf)
        if since > (-math.inf if last is None else last.t):
            text = f"failed at {min_sec_text(since)}"
        texts.append(f"#{id}: {text}")
    return ", ".join(texts)


def _coextensive(hfsm: Hfsm, group: Composite) -> frozenset[str]:
    """Return the names of the group and of the groups in it that hold exactly the same tasks."""
    composites = {c.id: c for c in hfsm.composites}
    names = {group.name}
    while (inner := composites.get(group.children[-1])) and len(group.children) == 1:
        group = inner
        names.add(group.name)
    return frozenset(names)


def _id_of(group: Composite | None) -> str | None:
    return None if group is None else group.id


def _outermost(hfsm: Hfsm) -> dict[str, Composite]:
    """Return the outermost group of each leaf in a group, by the leaf's id."""
    top: dict[str, Composite] = {}
    for group in hfsm.composites[1:]:
        top[group.id] = top.get(group.parent or "", group)
    return {leaf.id: top[leaf.parent] for leaf in hfsm.leaves if leaf.parent in top}
