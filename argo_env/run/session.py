"""One call from a mission to its record: the site, robot, world, drive and sensor put together."""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack

import numpy as np

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.errors import ArgoError
from argo_compiler.il import Mission, Task
from argo_env.drives.battery import Battery
from argo_env.drives.drive import Drive
from argo_env.drives.kinematic import KinematicDrive
from argo_env.drives.powertrain import Powertrain
from argo_env.drives.route import RouteDrive
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.faults.kinds import changed_site, settle
from argo_env.faults.schedule import Schedule
from argo_env.faults.targets import FaultTargets
from argo_env.navigation import Navigator
from argo_env.robot.spec import RobotSpec
from argo_env.run.action import Rig
from argo_env.run.journal import Header, Journal, JournalPlace, create_journal, fingerprints
from argo_env.run.record import Reordering, RunRecord
from argo_env.run.recorder import Recorder
from argo_env.run.runner import Announcer, LoggedEvents, MissionRunner, Observer
from argo_env.run.spec import RunSettings
from argo_env.seeding import generator
from argo_env.sensing.ideal import IdealSensor, draw_values
from argo_env.sensing.onboard import onboard_watches
from argo_env.sensing.onboard_sensor import OnboardSensor
from argo_env.sensing.sensor import Sensor
from argo_env.sensing.signals import standard_watches
from argo_env.sensing.vision.sensor import CameraSensor
from argo_env.sensing.watch import Watch
from argo_env.site import Site
from argo_env.surroundings import Surroundings
from argo_env.surroundings.network import RadioNetwork
from argo_env.world.paper_world import AnyWorld, PaperWorld
from argo_env.world.world import World

DriveMaker = Callable[[World, RobotSpec], Drive]
"""Makes a drive that moves the robot in the world."""

SensorMaker = Callable[[World, Mapping[int, float], int], Sensor]
"""Makes a sensor for the world, in which the checkpoints have these true values, with a seed."""


def _ideal(world: World, truth: Mapping[int, float], seed: int) -> Sensor:  # noqa: ARG001
    return IdealSensor(world, world.robot, truth)


def _camera(world: World, truth: Mapping[int, float], seed: int) -> Sensor:  # noqa: ARG001
    return CameraSensor(world, seed)


WORLD_DRIVES: dict[str, DriveMaker] = {"kinematic": KinematicDrive, "tracked": TrackedDrive}
"""The drives in PyBullet's world, by name."""

DRIVES = (RouteDrive.name, *WORLD_DRIVES)
"""The names of all drives; `route` has no world."""

SENSORS: dict[str, SensorMaker] = {"ideal": _ideal, CameraSensor.name: _camera}
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
    recorder: Recorder | None = None,
    reordering: Reordering | None = None,
) -> RunRecord:
    """Runs the mission on the navigator's site and returns its record.

    The settings' seed draws the checkpoints' true values, unless the settings give them. With
    `pace` a second of wall time shows at most that many seconds of simulated time. With `journal`
    the run can be resumed after its process has died. A `recorder` is told all that happens. The
    `reordering`, if the mission is in another order than it was written, goes into the record.
    Equal arguments give equal records.

    Raises:
        ArgoError: the mission makes no sense on this site, there is no such drive or sensor, or the
            journal can't be written.
    """
    settings = settings or RunSettings()
    check_settings(settings, navigator.site)
    observe = _paced(observe, pace)
    if journal is None:
        return _run(
            mission, settings, diagnostics, navigator, None, observe, announce, gui, recorder,
            reordering=reordering,
        )  # fmt: skip
    source = journal.source.resolve() if journal.source else None
    header = Header(
        site=journal.site,
        source=None if source is None else str(source),
        fingerprints=fingerprints(navigator, mission, source),
        settings=settings,
        mission=mission,
        diagnostics=diagnostics,
        reordering=reordering,
    )
    with create_journal(journal.path, header) as book:
        return _run(
            mission, settings, diagnostics, navigator, book, observe, announce, gui, recorder,
            reordering=reordering,
        )  # fmt: skip


def resume(
    journal: Journal,
    navigator: Navigator,
    *,
    observe: Observer | None = None,
    announce: Announcer | None = None,
    gui: bool = False,
    pace: float | None = None,
    recorder: Recorder | None = None,
    events: LoggedEvents = (),
) -> RunRecord:
    """Goes on with the run of a journal and returns the record of the whole of it.

    The robot goes on from where it was last known to be, and the action that ran begins anew. If
    the run had ended, its record is made again. Further `events` occur at their times (s), at once
    if these are over.

    Raises:
        ArgoError: the site, the robot, the mission's file or Argo is not what the run began with.
    """
    journal.require_unchanged(navigator)
    header = journal.header
    return _run(
        header.mission, header.settings, header.diagnostics, navigator, journal,
        _paced(observe, pace), announce, gui, recorder, events, header.reordering,
    )  # fmt: skip


def check_settings(settings: RunSettings, site: Site) -> None:
    """Raises ArgoError for settings that no run on the site can have."""
    if settings.drive not in DRIVES:
        raise ArgoError(f"no drive `{settings.drive}`; there are: {', '.join(DRIVES)}")
    if settings.sensor not in SENSORS:
        raise ArgoError(f"no sensor `{settings.sensor}`; there are: {', '.join(SENSORS)}")
    if settings.drive == RouteDrive.name and settings.sensor != IdealSensor.name:
        raise ArgoError(
            f"the drive `{settings.drive}` has no world that the sensor `{settings.sensor}` could "
            f"look at; take the sensor `{IdealSensor.name}` or another drive"
        )
    true_values(site, settings.seed, settings.values)
    settle(settings.faults, site, settings.seed)
    unseen = [f.kind for f in settings.faults if f.needs_world]
    if settings.drive == RouteDrive.name and unseen:
        raise ArgoError(
            f"the drive `{settings.drive}` has no world in which a fault like `{unseen[0]}` could "
            "be found; take another drive"
        )


def _run(
    mission: Mission,
    settings: RunSettings,
    diagnostics: tuple[Diagnostic, ...],
    navigator: Navigator,
    journal: Journal | None,
    observe: Observer | None,
    announce: Announcer | None,
    gui: bool,
    recorder: Recorder | None,
    events: LoggedEvents = (),
    reordering: Reordering | None = None,
) -> RunRecord:
    with ExitStack() as stack:
        rig = outfit(settings, navigator, gui, stack)
        runner = MissionRunner(mission, rig, settings, diagnostics, journal)
        if recorder:
            recorder.begin(rig, mission, settings)
        record = runner.run(observe, announce, recorder, events)
        record = record.model_copy(update={"reordering": reordering})
        if recorder:
            recorder.finish(record)
        return record


def outfit(settings: RunSettings, navigator: Navigator, gui: bool, stack: ExitStack) -> Rig:
    """All that a mission is carried out with, put together; `stack` closes it."""
    site, robot, seed = navigator.site, navigator.robot, settings.seed
    truth = true_values(site, seed, settings.values)
    faults = settle(settings.faults, site, seed)
    surroundings = Surroundings(site)
    world: AnyWorld
    watches: tuple[Watch, ...] = ()
    if settings.drive == RouteDrive.name:
        if gui:
            raise ArgoError(f"the drive `{settings.drive}` has no world to show in a window")
        world = PaperWorld(site, robot)
        inner: Drive = RouteDrive(robot)
        camera: Sensor = IdealSensor(world, robot, truth)
    else:
        real = changed_site(site, faults).elements
        world = stack.enter_context(World(site, robot, gui, real))
        inner = WORLD_DRIVES[settings.drive](world, robot)
        camera = SENSORS[settings.sensor](world, truth, seed)
        watches = standard_watches(world, surroundings, seed)
        for id, value in truth.items():
            world.show_value(id, value)
    drive, network, battery = Powertrain(inner), RadioNetwork(site), Battery(robot)
    sensor = OnboardSensor(camera, site, generator(seed, "instrument"))
    stage = FaultTargets(world, truth, surroundings, drive, sensor, battery, network)
    watches += onboard_watches(robot, battery, network, drive, sensor)
    schedule = Schedule(faults, stage)
    return Rig(world, navigator, drive, sensor, watches, battery, schedule)


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
