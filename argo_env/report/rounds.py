"""The runs of tasks in blocks: each visit to a group with its rounds, and what lies between."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from argo_compiler.hfsm import Composite, Hfsm
from argo_compiler.hfsm.conditions import words
from argo_compiler.hfsm.model import task_id
from argo_compiler.il import Condition
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_env.formatting import clock
from argo_env.report.waiting import Wait
from argo_env.run.record import GivenValue, Reading, RoundRun, RunRecord, TaskRun


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


def blocks(hfsm: Hfsm, runs: Sequence[TaskRun]) -> tuple[Block, ...]:
    """The runs in their order.

    A round of a group begins with a run of its initial task after its last one, or after one that
    was cancelled. Where a group and another one in it have both tasks in common, the rounds of the
    inner one are counted. The drive of a reaction belongs to the visit that it interrupts.
    """
    outermost = _outermost(hfsm)
    groups: list[Composite | None] = []
    for run in runs:
        around = groups[-1] if groups and run.task in RESERVED_NAMES else None
        groups.append(outermost.get(task_id(run.task), around))
    result = []
    for id, part in groupby(zip(groups, runs, strict=True), key=lambda pair: _id_of(pair[0])):
        visit = tuple(run for _, run in part)
        group = outermost.get(task_id(visit[0].task))
        if id is None or group is None:
            result.append(Block(None, (visit,)))
            continue
        last = _last_leaf(hfsm, group)
        begins = [
            i
            for i, run in enumerate(visit)
            if i == 0
            or (
                task_id(run.task) == group.initial
                and (task_id(visit[i - 1].task) == last or visit[i - 1].outcome == "cancelled")
            )
        ]
        ends = [*begins[1:], len(visit)]
        rounds = tuple(visit[i:j] for i, j in zip(begins, ends, strict=True))
        result.append(Block(group.name, rounds))
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
        (one, _values(record, until.get(one.group, ()), one.ended) if one.ended else "")
        for one in record.rounds
    ]


def repeat_rules(record: RunRecord) -> list[str]:
    """What the plan says of these rounds, for each of their groups a sentence."""
    rules = []
    for group in record.hfsm.composites[1:]:
        repeat = group.repeat
        if repeat is None or not (repeat.every or repeat.until):
            continue
        said = [f"a round every {repeat.every:g} s"] if repeat.every else []
        said += [f"until {' and '.join(map(words, repeat.until))}"] if repeat.until else []
        said += [f"{repeat.count} rounds at most"] if repeat.count else []
        said += [f"for {repeat.duration:g} s at most"] if repeat.duration else []
        rules.append(f"{group.name}: {', '.join(said)}.")
    return rules


def _values(record: RunRecord, until: Sequence[Condition], at: float) -> str:
    """The last value before the time `at` (s) of each checkpoint that the conditions look at."""
    said = []
    for id in dict.fromkeys(condition.object_id for condition in until):
        told: list[Reading | GivenValue] = [*record.readings, *record.given_values]
        before = [one for one in told if str(one.checkpoint) == id and one.t <= at]
        last = max(before, key=lambda one: one.t, default=None)
        text = "no value" if last is None else f"{last.value:.4g} {last.unit} at {clock(last.t)}"
        said.append(f"#{id}: {text}")
    return ", ".join(said)


def _last_leaf(hfsm: Hfsm, group: Composite) -> str:
    composites = {c.id: c for c in hfsm.composites}
    last = group.children[-1]
    while last in composites:
        last = composites[last].children[-1]
    return last


def _id_of(group: Composite | None) -> str | None:
    return None if group is None else group.id


def _outermost(hfsm: Hfsm) -> dict[str, Composite]:
    """The outermost group that each leaf lies in."""
    top: dict[str, Composite] = {}
    for group in hfsm.composites[1:]:
        top[group.id] = top.get(group.parent or "", group)
    return {leaf.id: top[leaf.parent] for leaf in hfsm.leaves if leaf.parent in top}
