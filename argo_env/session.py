"""One call from a mission to its record: the site, robot, world, drive and sensor put together."""

import time
from collections.abc import Callable, Mapping

import numpy as np

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.errors import ArgoError
from argo_compiler.il import Mission, Task
from argo_env.action import Rig
from argo_env.journal import Header, Journal, JournalPlace, create_journal, fingerprints
from argo_env.navigation import Navigator
from argo_env.record import RunRecord
from argo_env.robot.kinematic import KinematicDrive
from argo_env.runner import Announcer, MissionRunner, Observer
from argo_env.sensing.ideal import IdealSensor, draw_values
from argo_env.sensing.sensor import Sensor
from argo_env.settings import RunSettings
from argo_env.site import Site
from argo_env.world import World

SensorMaker = Callable[[World, Mapping[int, float], int], Sensor]
"""Makes a sensor for the world, in which the checkpoints have these true values, with a seed."""


def _ideal(world: World, truth: Mapping[int, float], seed: int) -> Sensor:  # noqa: ARG001
    return IdealSensor(world, world.robot, truth)


DRIVES = {"kinematic": KinematicDrive}
"""The drives by name."""

SENSORS: dict[str, SensorMaker] = {"ideal": _ideal}
"""The sensors for checkpoints, by name."""


def simulate(
    mission: Mission,
    navigator: Navigator,
    *,
    settings: RunSettings | None = None,
    diagnostics: tuple[Diagnostic, ...] = (),
    observe: Observer | None = None,
    announce: Announcer | None = None,
    gui: bool = False,
    pace: float | None = None,
    journal: JournalPlace | None = None,
) -> RunRecord:
    """Runs the mission on the navigator's site and returns its record.

    The settings' seed draws the checkpoints' true values, unless the settings give them. With
    `pace` a second of wall time shows at most that many seconds of simulated time. With `journal`
    the run can be resumed after its process has died. Equal arguments give equal records.

    Raises:
        ArgoError: the mission makes no sense on this site, there is no such drive or sensor, or the
            journal can't be written.
    """
    settings = settings or RunSettings()
    check_settings(settings, navigator.site)
    observe = _paced(observe, pace)
    if journal is None:
        return _run(mission, settings, diagnostics, navigator, None, observe, announce, gui)
    source = journal.source.resolve() if journal.source else None
    header = Header(
        site=journal.site,
        source=None if source is None else str(source),
        fingerprints=fingerprints(navigator, mission, source),
        settings=settings,
        mission=mission,
        diagnostics=diagnostics,
    )
    with create_journal(journal.path, header) as book:
        return _run(mission, settings, diagnostics, navigator, book, observe, announce, gui)


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
    return _run(
        header.mission, header.settings, header.diagnostics, navigator, journal,
        _paced(observe, pace), announce, gui,
    )  # fmt: skip


def check_settings(settings: RunSettings, site: Site) -> None:
    """Raises ArgoError for settings that no run on the site can have."""
    if settings.drive not in DRIVES:
        raise ArgoError(f"no drive `{settings.drive}`; there are: {', '.join(DRIVES)}")
    if settings.sensor not in SENSORS:
        raise ArgoError(f"no sensor `{settings.sensor}`; there are: {', '.join(SENSORS)}")
    true_values(site, settings.seed, settings.values)


def _run(
    mission: Mission,
    settings: RunSettings,
    diagnostics: tuple[Diagnostic, ...],
    navigator: Navigator,
    journal: Journal | None,
    observe: Observer | None,
    announce: Announcer | None,
    gui: bool,
) -> RunRecord:
    truth = true_values(navigator.site, settings.seed, settings.values)
    with World(navigator.site, navigator.robot, gui) as world:
        for id, value in truth.items():
            world.show_value(id, value)
        drive = DRIVES[settings.drive](world, navigator.robot)
        sensor = SENSORS[settings.sensor](world, truth, settings.seed)
        rig = Rig(world, navigator, drive, sensor)
        return MissionRunner(mission, rig, settings, diagnostics, journal).run(observe, announce)


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
