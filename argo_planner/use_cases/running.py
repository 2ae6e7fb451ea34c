"""Runs of missions: what they are told, and the spec that `argo_env.run.session` carries out."""

import json
import logging
import math

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.hfsm import Cancel, Event, GiveBack, Occurred, Pause, Resume, TakeOver, lower
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import EventKind, Mission
from argo_env.run.record import Reordering
from argo_env.run.spec import RunSpec, read_spec
from argo_planner.use_cases.importing import ImportedMission, Upload

_log = logging.getLogger(__name__)

NO_MISSION = Mission(tasks=())
"""stands in a spec until its mission is known"""

EVENTS: dict[str, Event] = {
    **{str(kind): Occurred(kind) for kind in EventKind if kind is not EventKind.TIME_UP},
    "pause": Pause(),
    "resume": Resume(),
    "take_over": TakeOver(),
    "give_back": GiveBack(),
    "cancel": Cancel(),
}
"""What a run can be told, by name."""
READING = "reading"
"""with what was read: `reading:8=4.2`"""


def event_named(name: str) -> Event:
    """The event of that name. Raises NotFound if there is none, Invalid if it can't be told."""
    kind, _, said = name.partition(":")
    if kind == READING:
        return _reading(said)
    if name == EventKind.TIME_UP:
        raise Invalid("it occurs by itself, at the mission's max_duration")
    if name not in EVENTS:
        raise NotFound(f"no event `{name}`; there are: {', '.join(EVENTS)}, {READING}:ID=VALUE")
    return EVENTS[name]


def _reading(said: str) -> ReadingGiven:
    id, _, value = said.partition("=")
    try:
        read = float(value)
    except ValueError:
        read = math.nan
    if not id.strip() or not math.isfinite(read):
        raise Invalid(f"write {READING}:ID=VALUE, such as {READING}:8=4.2")
    return ReadingGiven(id.strip(), read)


def is_spec(upload: Upload) -> bool:
    """Whether it is the spec of a run: JSON with a mission in it, and how that is run."""
    content = upload.content
    if not isinstance(content, bytes) or b'"mission"' not in content:
        return False
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        return False
    return isinstance(data, dict) and {"mission", "drive", "seed"} <= data.keys()


def spec_of(upload: Upload) -> RunSpec:
    """The spec of a run. Raises Invalid, with the place, for one that makes no sense, and
    DiagnosticError if its mission does not."""
    assert isinstance(upload.content, bytes)
    spec = read_spec(upload.content, upload.name)
    lower(spec.mission, source_name=upload.name)
    return spec


def with_mission(
    spec: RunSpec, imported: ImportedMission, reordering: Reordering | None = None
) -> RunSpec:
    """The spec of a run of that mission. Raises DiagnosticError for one that makes no sense."""
    lower(imported.mission, source_name=imported.source_name)
    known = {
        "mission": imported.mission,
        "diagnostics": imported.diagnostics,
        "reordering": reordering,
    }
    _log.info("%s: %d tasks to run", imported.source_name, len(imported.mission.tasks))
    return spec.model_copy(update=known)
