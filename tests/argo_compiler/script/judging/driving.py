"""A robot model in which every action takes the same time, so that a mission's meaning shows."""

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Executor,
    Occurred,
    Resume,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import Action, EventKind, Mission, Mode, Task

MAX_STEPS = 1000  # actions of one trace; a plan that takes more does not end
SAME_PLACE = 0.5  # m


@dataclass
class Step:
    """Something that the robot did: a token, when it began, and where."""

    token: str
    at: float
    place: tuple[float, ...] = ()
    velocity: float | None = None
    """m/s, asked for on the way there"""
    ended: float | None = None
    stopped: bool = False


def place_token(catalog: Catalog, pose: Pose) -> str:
    """What a drive to there is called in a trace."""
    for area in catalog.areas:
        if _near(area.dock, pose):
            return f"D{area.number}"
    for known in catalog.places:
        if _near(known.pose, pose):
            return f"W@{known.name}"
    floor = min(catalog.floors, key=lambda floor: abs(floor.z - pose.z))
    return f"W@{floor.number}"


class Drive:
    """Drives a mission by a trace's values, events and failures, and notes what the robot does.

    A reading outside its nominal range is told as an event just before its action ends, as the
    robot does it. What happened is in `steps`.
    """

    def __init__(self, mission: Mission, catalog: Catalog, trace: dict[str, Any]) -> None:
        self._catalog = catalog
        self._values = trace.get("values", {})
        self._action_s = float(trace.get("action_s", 30))
        self._events = sorted(trace.get("events", ()), key=lambda event: event[0])
        self._fails = dict(trace.get("fails", {}))
        self._read: Counter[str] = Counter()
        self._supervised = mission.mode is Mode.SUPERVISORY
        self._executor = Executor(lower(mission))
        self._now = 0.0
        self._running: tuple[Task, Step] | None = None
        self._idle_since: float | None = 0.0
        self.steps: list[Step] = []

    def run(self) -> list[Step]:
        """What the robot did, to the end of the mission or until nothing happens any more."""
        self._obey(self._executor.start(0.0))
        if self._supervised:
            self._obey(self._executor.handle(Resume(), 0.0))  # the operator lets it begin
        turns = 0
        while not self._executor.finished:
            turns += 1
            end = self._running[1].at + self._action_s if self._running else math.inf
            event = self._events[0][0] if self._events else math.inf
            deadline = self._executor.next_deadline
            due = math.inf if deadline is None else deadline
            if min(end, event, due) == math.inf:
                self.steps.append(Step("H", self._now))
                return _tidy(self.steps)
            if turns > MAX_STEPS * 3 or len(self.steps) > MAX_STEPS:
                self.steps.append(Step("...", self._now))
                return _tidy(self.steps)
            self._now = max(self._now, min(end, event, due))
            if end <= min(event, due):
                self._end_action()
            elif event <= due:
                _, kind, *level = self._events.pop(0)
                detail = f"{level[0]:g} %" if level else ""
                self._obey(self._executor.handle(Occurred(EventKind(kind), detail), self._now))
            else:
                self._obey(self._executor.handle(Tick(), self._now), waited=True)
        drives = [s for s in self.steps if s.token[0] in "MWD"]
        if not (drives and drives[-1].token.startswith("D") and not drives[-1].stopped):
            self.steps.append(Step("X", self._now))
        return _tidy(self.steps)

    def _obey(self, commands: Sequence[Any], waited: bool = False) -> None:
        for command in commands:
            if isinstance(command, StartAction):
                self._begin(command.task, waited)
            elif isinstance(command, CancelAction) and self._running:
                task, _ = self._running
                self._stop(stopped=True)
                self._obey(self._executor.handle(ActionStopped(task.name), self._now))

    def _begin(self, task: Task, waited: bool) -> None:
        """Begins an action, and notes how long nothing was done before it if the plan says so."""
        if waited and self._idle_since is not None and self._now > self._idle_since:
            gap = self._now - self._idle_since
            self.steps.append(Step(f"P{gap:g}", self._idle_since, ended=self._now))
        if task.action is Action.MEASURE:
            token, place = f"M{_number(task)}", ()
        else:
            assert task.pose is not None
            token = place_token(self._catalog, task.pose)
            place = (round(task.pose.x, 2), round(task.pose.y, 2), round(task.pose.z, 2))
        step = Step(token, self._now, place, task.velocity)
        self.steps.append(step)
        self._running = (task, step)
        self._idle_since = None

    def _stop(self, stopped: bool = False) -> None:
        assert self._running
        _, step = self._running
        step.ended, step.stopped = self._now, stopped
        self._running = None
        self._idle_since = self._now

    def _end_action(self) -> None:
        assert self._running
        task, step = self._running
        value, abnormal = None, False
        if step.token.startswith("M"):
            key = _number(task)
            if self._fails.get(key, 0) > 0:
                self._fails[key] -= 1
                self._stop()
                failed = ActionFailed(task.name, "it could not be read")
                self._obey(self._executor.handle(failed, self._now))
                return
            value = self._value(key)
            checkpoint = self._catalog.checkpoint(int(key))
            assert checkpoint is not None
            if not checkpoint.nominal.contains(value):
                abnormal = True
                # The action goes on until its end, which follows at once.
                self._executor.handle(Occurred(EventKind.ABNORMAL_READING), self._now)
        self._stop()
        ended = ActionSucceeded(task.name, value, abnormal=abnormal)
        self._obey(self._executor.handle(ended, self._now))

    def _value(self, key: str) -> float:
        listed = self._values.get(key)
        if listed is None:
            checkpoint = self._catalog.checkpoint(int(key))
            assert checkpoint is not None, f"checkpoint {key}"
            return (checkpoint.nominal.low + checkpoint.nominal.high) / 2
        values = listed if isinstance(listed, list) else [listed]
        k = min(self._read[key], len(values) - 1)
        self._read[key] += 1
        return float(values[k])


def _number(task: Task) -> str:
    return re.sub(r"\D", "", str(task.object_id))


def _near(a: Pose, b: Pose) -> bool:
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z)) < SAME_PLACE


def _tidy(steps: Sequence[Step]) -> list[Step]:
    """Without what was cancelled before it began; waits in one piece, docks said once."""
    tidy: list[Step] = []
    for step in steps:
        last = tidy[-1] if tidy else None
        if step.stopped and step.ended == step.at:
            continue
        if last and last.token[0] == step.token[0] == "P" and last.ended == step.at:
            seconds = float(last.token[1:]) + float(step.token[1:])
            tidy[-1] = Step(f"P{seconds:g}", last.at, ended=step.ended)
        elif last and step.token[0] == "D" and step.token == last.token and not last.stopped:
            continue
        else:
            tidy.append(step)
    return tidy
