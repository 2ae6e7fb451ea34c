"""Processing of an input: reading, check, analysis, and events for its machine."""

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
from argo_compiler.script import decode_script, format_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.mission_writing import unplaced
from tests.whole_scripts import import_whole

STEPS = 30
"""number of events that the machine of a mission handles"""
ACTION_ENDS = (ActionSucceeded, ActionFailed, ActionStopped)


def try_script(data: bytes, rng: random.Random) -> str:
    """Return `mission` or `refused` for a script."""
    try:
        text = decode_script(data, "fuzz")
        area = rng.choice((None, 1, 2))
        mission = import_whole(text, CATALOG, start_area=area, end_area=area).mission
    except ArgoError:
        return "refused"
    run(mission, rng)
    if not has_errors(check(mission, CATALOG)):
        again = import_whole(format_script(mission, CATALOG), CATALOG).mission
        assert unplaced(again) == unplaced(mission), "formatting changes the mission"
    return "mission"


def try_mission(data: bytes, rng: random.Random, folder: Path) -> str:
    """Return `mission` or `refused` for a mission file."""
    path = folder / "fuzz.json"
    path.write_bytes(data)
    try:
        mission = read_mission(path)
    except ArgoError:
        return "refused"
    return run(mission, rng)


def run(mission: Mission, rng: random.Random) -> str:
    """Analyse the mission, and let its machine handle some events, half of them after a restore."""
    check(mission, CATALOG)
    try:
        hfsm = lower(mission)
    except ArgoError:
        return "refused"
    analyse(mission, CATALOG)
    executor = Executor(hfsm)
    now = 0.0
    cancelled = _contains_cancel(executor.start(now))
    for step in range(STEPS):
        if executor.finished:
            break
        if step == STEPS // 2:
            progress = Progress.model_validate_json(executor.progress().model_dump_json())
            executor = Executor.restore(hfsm, progress, now)
            cancelled = _contains_cancel(executor.start(now))
            continue
        now += rng.choice((0.0, 0.5, 30.0))
        event = _draw_event(executor.running, cancelled, rng)
        still_cancelled = cancelled and not isinstance(event, ACTION_ENDS)
        cancelled = _contains_cancel(executor.handle(event, now)) or still_cancelled
    return "mission"


def _contains_cancel(commands: Sequence[Command]) -> bool:
    return any(isinstance(command, CancelAction) for command in commands)


def _draw_event(running: Task | None, cancelled: bool, rng: random.Random) -> Event:
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
