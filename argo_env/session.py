"""One call from a mission to its record: the site, robot, world, drive and sensor put together."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext

import numpy as np

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.errors import ArgoError
from argo_compiler.hfsm import Event
from argo_compiler.il import Mission, Task
from argo_env.action import Rig
from argo_env.journal import Header, Journal, JournalPlace, create_journal, fingerprints
from argo_env.log import LoggedEvent
from argo_env.navigation import Navigator
from argo_env.record import RunRecord
from argo_env.robot.kinematic import KinematicDrive
from argo_env.runner import Announcer, MissionRunner, Observer
from argo_env.sensing.ideal import IdealSensor, draw_values
from argo_env.site import Site
from argo_env.world import World

DRIVES = {"kinematic": KinematicDrive}
"""The drives by name."""


def simulate(
    mission: Mission,
    navigator: Navigator,
    *,
    seed: int = 0,
    drive: str = "kinematic",
    values: Mapping[int, float] | None = None,
    events: Sequence[tuple[float, Event]] = (),
    diagnostics: tuple[Diagnostic, ...] = (),
    observe: Observer | None = None,
    announce: Announcer | None = None,
    gui: bool = False,
    pace: float | None = None,
    journal: JournalPlace | None = None,
) -> RunRecord:
    """Runs the mission on the navigator's site and returns its record.

    The seed draws the checkpoints' true values; `values` replaces some of them. The `events` occur
    at their simulated times (s). With `pace` a second of wall time shows at most that many seconds
    of simulated time. With `journal` the run can be resumed after its process has died. Equal
    arguments give equal records.

    Raises:
        ArgoError: the mission makes no sense on this site, there is no such drive, or the journal
            can't be written.
    """
    if drive not in DRIVES:
        raise ArgoError(f"no drive `{drive}`; there are: {', '.join(DRIVES)}")
    truth = true_values(navigator.site, seed, values or {})
    source = journal.source.resolve() if journal and journal.source else None
    header = Header(
        site=journal.site if journal else navigator.site.name,
        source=None if source is None else str(source),
        fingerprints=fingerprints(navigator, mission, source) if journal else {},
        drive=drive,
        seed=seed,
        values=dict(values or {}),
        events=tuple((t, LoggedEvent.of(event)) for t, event in events),
        mission=mission,
        diagnostics=diagnostics,
    )
    with create_journal(journal.path, header) if journal else nullcontext() as book:
        return _run(header, navigator, truth, book, _paced(observe, pace), announce, gui)


def resume(
    journal: Journal,
    navigator: Navigator,
    *,
    observe: Observer | None = None,
    announce: Announcer | None = None,
    gui: bool = False,
    pace: float | None = None,
) -> RunRecord:
    """Goes on with the run of a journal and returns the record of the whole of it.

    The robot goes on from where it was last known to be, and the action that ran begins anew. If
    the run had ended, its record is made again.

    Raises:
        ArgoError: the site, the robot, the mission's file or Argo is not what the run began with.
    """
    journal.require_unchanged(navigator)
    header = journal.header
    truth = true_values(navigator.site, header.seed, header.values)
    return _run(header, navigator, truth, journal, _paced(observe, pace), announce, gui)


def _run(
    header: Header,
    navigator: Navigator,
    truth: Mapping[int, float],
    journal: Journal | None,
    observe: Observer | None,
    announce: Announcer | None,
    gui: bool,
) -> RunRecord:
    with World(navigator.site, navigator.robot, gui) as world:
        for id, value in truth.items():
            world.show_value(id, value)
        rig = Rig(
            world,
            navigator,
            DRIVES[header.drive](world, navigator.robot),
            IdealSensor(world, navigator.robot, truth),
        )
        runner = MissionRunner(
            header.mission,
            rig,
            header.seed,
            header.diagnostics,
            [(t, event.original()) for t, event in header.events],
            journal,
        )
        return runner.run(observe, announce)


def true_values(site: Site, seed: int, given: Mapping[int, float]) -> dict[int, float]:
    """What each checkpoint shows, in its unit: drawn by the seed, or as given.

    Raises ArgoError for a checkpoint that the site does not have or a value beyond its scale.
    """
    truth = draw_values(site, np.random.default_rng(seed))
    for id, value in given.items():
        if id not in truth:
            raise ArgoError(f"site {site.name} has no checkpoint {id} to give a value to")
        checkpoint = site.checkpoint(id)
        if not checkpoint.range.contains(value):
            raise ArgoError(
                f"checkpoint {id} ({checkpoint.name}) shows {checkpoint.range.low:g} to "
                f"{checkpoint.range.high:g} {checkpoint.unit}, not {value:g}"
            )
        truth[id] = value
    return truth


def _paced(
    observe: Observer | None, pace: float | None, sleep: Callable[[float], None] = time.sleep
) -> Observer | None:
    """The observer, called no faster than `pace` simulated seconds a second."""
    if pace is None:
        return observe
    begun: list[float] = []

    def wait(now: float, task: Task | None) -> None:
        if not begun:
            # A run that is resumed does not begin at 0.
            begun.append(time.monotonic() - now / pace)
        sleep(max(0.0, begun[0] + now / pace - time.monotonic()))
        if observe:
            observe(now, task)

    return wait
