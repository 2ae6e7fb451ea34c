"""What becomes of an input: it is read, checked, analysed, its machine is given some events."""

import random
from collections.abc import Sequence
from pathlib import Path

from argo_compiler.analysis import analyse
from argo_compiler.base.errors import ArgoError
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.files.mission_file import read_mission
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Command,
    Event,
    Executor,
    Occurred,
    Pause,
    Progress,
    Resume,
    Tick,
    lower,
)
from argo_compiler.il import Action, EventKind, Mission, Task
from argo_compiler.script import decode_script, format_script, import_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.mission_writing import unplaced

STEPS = 30
"""events that the machine of a mission is given"""
ACTION_ENDS = (ActionSucceeded, ActionFailed, ActionStopped)


def try_script(data: bytes, rng: random.Random) -> str:
    """What became of a script: `mission` or `refused`."""
    try:
        text = decode_script(data, "fuzz")
        area = rng.choice((None, 1, 2))
        mission = import_script(text, CATALOG, start_area=area, end_area=area).mission
    except ArgoError:
        return "refused"
    run(mission, rng)
    if not has_errors(check(mission, CATALOG)):
        again = import_script(format_script(mission, CATALOG), CATALOG).mission
        assert unplaced(again) == unplaced(mission), "formatting changes the mission"
    return "mission"


def try_mission(data: bytes, rng: random.Random, folder: Path) -> str:
    """What became of a mission file: `mission` or `refused`."""
    path = folder / "fuzz.json"
    path.write_bytes(data)
    try:
        mission = read_mission(path)
    except ArgoError:
        return "refused"
    return run(mission, rng)


def run(mission: Mission, rng: random.Random) -> str:
    """Analyses the mission and gives its machine some events, across a snapshot."""
    check(mission, CATALOG)
    try:
        hfsm = lower(mission)
    except ArgoError:
        return "refused"
    analyse(mission, CATALOG)
    executor = Executor(hfsm)
    now = 0.0
    cancelled = _cancels(executor.start(now))
    for step in range(STEPS):
        if executor.finished:
            break
        if step == STEPS // 2:
            progress = Progress.model_validate_json(executor.progress().model_dump_json())
            executor = Executor.restore(hfsm, progress, now)
            cancelled = _cancels(executor.start(now))
            continue
        now += rng.choice((0.0, 0.5, 30.0))
        event = _event(executor.running, cancelled, rng)
        still = cancelled and not isinstance(event, ACTION_ENDS)
        cancelled = _cancels(executor.handle(event, now)) or still
    return "mission"


def _cancels(commands: Sequence[Command]) -> bool:
    return any(isinstance(command, CancelAction) for command in commands)


def _event(running: Task | None, cancelled: bool, rng: random.Random) -> Event:
    choice = rng.random()
    if choice < 0.05:
        return Pause()
    if choice < 0.1 or (running is None and choice < 0.8):
        return Resume()
    if choice < 0.15:
        return Occurred(rng.choice(list(EventKind)))
    if running is None or choice < 0.2:
        return Tick()
    if cancelled and choice < 0.8:
        return ActionStopped(running.name)
    if choice < 0.3:
        return ActionFailed(running.name, "fuzz")
    reads = running.action is Action.MEASURE
    return ActionSucceeded(running.name, rng.uniform(-1, 100) if reads else None)
