"""What a plan has to say besides what the robot does: its header, and what its tasks carry."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission, Task
from tests.argo_compiler.script.judging.driving import Step, place_token

FIELDS = {"max_duration_s": "max_duration"}  # of a mission, where the header's key is another


def compare_header(header: dict[str, Any], mission: Mission, catalog: Catalog) -> Iterator[str]:
    """What of the header differs."""
    for key, wanted in header.items():
        if key == "start_place":
            pose = next((t.pose for t in mission.tasks if t.action.value == "START"), None)
            if pose is None or place_token(catalog, pose) != f"W@{wanted}":
                yield f"the mission should start at {wanted}"
            continue
        got = getattr(mission, FIELDS.get(key, key))
        if got != wanted:
            yield f"{key} should be {wanted}, is {got}"


def compare_requirements(
    requirements: dict[str, Any], mission: Mission, steps: Sequence[Step]
) -> Iterator[str]:
    """What of the requirements differs."""
    for name, wanted in requirements.items():
        if name in REQUIREMENTS and (difference := REQUIREMENTS[name](wanted, mission, steps)):
            yield difference


def _measures(mission: Mission, key: str) -> list[Task]:
    return [t for t in mission.tasks if t.object_id == key]


def _optional(wanted: Sequence[str], mission: Mission, _: Sequence[Step]) -> str | None:
    got = {t.object_id for t in mission.tasks if t.optional and t.object_id}
    return None if got == set(wanted) else f"optional should be {wanted}, is {sorted(got)}"


def _priority(wanted: Sequence[Sequence[str]], mission: Mission, _: Sequence[Step]) -> str | None:
    worth = [[t.priority for key in keys for t in _measures(mission, key)] for keys in wanted]
    falls = all(worth) and all(min(a) > max(b) for a, b in pairwise(worth))
    return None if falls else f"priorities should fall along {wanted}, are {worth}"


def _window(
    wanted: dict[str, Sequence[float | None]], mission: Mission, _: Sequence[Step]
) -> str | None:
    for key, (earliest, latest) in wanted.items():
        windows = [t.window for t in _measures(mission, key) if t.window]
        if not any((w.earliest, w.latest) == (earliest or 0, latest) for w in windows):
            return f"the window of {key} should be {[earliest, latest]}, is {windows}"
    return None


def _speed(wanted: dict[str, float], _: Mission, steps: Sequence[Step]) -> str | None:
    for key, speed in wanted.items():
        ways = [s.velocity for s in steps if s.token == f"M{key}"]
        if not ways or any(v is None or abs(v - speed) > 0.005 for v in ways):
            return f"the way to {key} should be driven at {speed} m/s, is at {ways}"
    return None


def _before(wanted: Sequence[Sequence[str]], mission: Mission, _: Sequence[Step]) -> str | None:
    of = {task.name: task.object_id for task in mission.tasks}
    got = {(of.get(first), of.get(second)) for first, second in mission.before}
    return None if got == {tuple(pair) for pair in wanted} else f"before should be {wanted}"


def _battery_below(wanted: float, mission: Mission, _: Sequence[Step]) -> str | None:
    got = [r.battery_below for r in mission.reactions if r.battery_below is not None]
    right = len(got) == 1 and abs(got[0] - wanted / 100) < 1e-9
    return None if right else f"the battery should be low below {wanted} %, is below {got}"


REQUIREMENTS: dict[str, Callable[[Any, Mission, Sequence[Step]], str | None]] = {
    "optional": _optional,
    "priority": _priority,
    "window": _window,
    "speed": _speed,
    "before": _before,
    "battery_below": _battery_below,
}
"""How each is read from a mission and the steps of its first trace."""
