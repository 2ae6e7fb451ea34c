"""Specs and events of runs, which `argo_env.run.session` carries out."""

import json
import logging
import math

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.hfsm import Cancel, Event, GiveBack, Occurred, Pause, Resume, TakeOver, lower
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import EventKind, Mission
from argo_env.run.record import Reordering
from argo_env.run.spec import RunSpec, read_spec
from argo_planner.use_cases.importing import ImportedMission, Upload

_log = logging.getLogger(__name__)

NO_MISSION = Mission(tasks=())
"""mission of a spec until the real one is known"""

EVENTS: dict[str, Event] = {
    **{str(kind): Occurred(kind) for kind in EventKind if kind is not EventKind.TIME_UP},
    "pause": Pause(),
    "resume": Resume(),
    "take_over": TakeOver(),
    "give_back": GiveBack(),
    "cancel": Cancel(),
}
"""events that a person can send to a run, by name; those with a reading are not among them"""
READING = "reading"
"""kind of event with a reading, such as `reading:8=4.2`"""


def parse_event(name: str) -> Event:
    """Return the event of a name in `EVENTS`, or of the text `reading:ID=VALUE`.

    Raises:
        NotFound: There is no such event.
        Invalid: Nobody can report it, or a reading has another form.
    """
    kind, _, value = name.partition(":")
    if kind == READING:
        return _parse_reading(value)
    if name == EventKind.TIME_UP:
        raise Invalid("this event occurs by itself, at the mission's maximum duration")
    if name not in EVENTS:
        raise NotFound(
            Message(
                "no event `{name}`; there are: {events}, {reading}:ID=VALUE",
                name=name,
                events=Listing(EVENTS),
                reading=READING,
            )
        )
    return EVENTS[name]


def _parse_reading(text: str) -> ReadingGiven:
    id, _, value = text.partition("=")
    try:
        read = float(value)
    except ValueError:
        read = math.nan
    if not id.strip() or not math.isfinite(read):
        raise Invalid(Message("write {reading}:ID=VALUE, such as {reading}:8=4.2", reading=READING))
    return ReadingGiven(id.strip(), read)


def is_run_spec(upload: Upload) -> bool:
    """Return True if an upload is the spec of a run: JSON with a mission, a drive and a seed.

    The record of a run, which has a result too, is none.
    """
    content = upload.content
    if not isinstance(content, bytes) or b'"mission"' not in content:
        return False
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        return False
    fields = data.keys() if isinstance(data, dict) else ()
    return {"mission", "drive", "seed"} <= {*fields} and "result" not in fields


def load_spec(upload: Upload) -> RunSpec:
    """Read and check the spec of a run.

    Raises:
        Invalid: The spec has errors; the message names the place.
        DiagnosticError: Its mission has errors.
    """
    assert isinstance(upload.content, bytes)
    spec = read_spec(upload.content, upload.name)
    lower(spec.mission, source_name=upload.name)
    return spec


def with_mission(
    spec: RunSpec, imported: ImportedMission, reordering: Reordering | None = None
) -> RunSpec:
    """Return a copy of the spec with the mission and its diagnostics.

    Args:
        spec: the spec of a run, whose mission is replaced
        imported: the mission
        reordering: description of the change of its order; None: it has its written order

    Raises:
        DiagnosticError: The mission has errors.
    """
    lower(imported.mission, source_name=imported.source_name)
    known = {
        "mission": imported.mission,
        "diagnostics": imported.diagnostics,
        "reordering": reordering,
    }
    _log.info("%s: %d tasks to run", imported.source_name, len(imported.mission.tasks))
    return spec.model_copy(update=known)
