"""Run setup: world, navigator, drive, sensor, watches and faults of a run, and displayed values."""

import math
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Listing, Message
from argo_env.drives.battery import Battery
from argo_env.drives.drive import Drive
from argo_env.drives.powertrain import Powertrain
from argo_env.drives.timed_drive import RouteDrive
from argo_env.faults.kinds import resolve_faults, site_with_faults
from argo_env.faults.loading import FaultText
from argo_env.faults.schedule import FaultSchedule
from argo_env.faults.targets import FaultTargets
from argo_env.navigation import Navigator
from argo_env.run.drives_and_sensors import IDEAL, ROUTE, SENSORS, WORLD_DRIVES, drive_names
from argo_env.run.spec import RunSpec, ValueProfile
from argo_env.seeding import generator
from argo_env.sensing.ideal import IdealSensor, draw_nominal_values
from argo_env.sensing.onboard import SensorWithFaults, onboard_watches
from argo_env.sensing.sensor import Measurement, Sensor
from argo_env.sensing.signals import standard_watches
from argo_env.sensing.watch import Watch
from argo_env.site import Site, SiteCheckpoint
from argo_env.surroundings import Surroundings
from argo_env.surroundings.surroundings import RadioNetwork
from argo_env.world.pybullet_client import require_pybullet
from argo_env.world.without_physics import AnyWorld, WorldWithoutPhysics
from argo_env.world.world import World


class Instruments:
    """Instruments of the site, which display values that change over time.

    A fault that changes a value has priority over the value's profile.
    """

    def __init__(
        self, targets: FaultTargets, site: Site, seed: int, profiles: Mapping[int, ValueProfile]
    ) -> None:
        """Take the profiles, each by the number of the checkpoint whose value changes by it.

        Raises NotFound for a checkpoint that the site does not have.
        """
        self._targets = targets
        self._site = site
        self._seed = seed
        self._profiles = {site.checkpoint(id).id: profile for id, profile in profiles.items()}
        self._first = {id: targets.fault_free_values[id] for id in self._profiles}

    def update_displayed_value(self, checkpoint_id: int, now: float) -> None:
        """Set the value that the checkpoint displays at time `now` (s), before it is read."""
        self._targets.sensor.time = now
        profile = self._profiles.get(checkpoint_id)
        if profile is None:
            return
        checkpoint = self._site.checkpoint(checkpoint_id)
        value = displayed_value(checkpoint, self._first[checkpoint_id], profile, self._seed, now)
        has_no_fault = (
            self._targets.truth[checkpoint_id] == self._targets.fault_free_values[checkpoint_id]
        )
        self._targets.fault_free_values[checkpoint_id] = value
        if has_no_fault:
            self._targets.show_value(checkpoint_id, value)


def displayed_value(
    checkpoint: SiteCheckpoint, first: float, profile: ValueProfile, seed: int, now: float
) -> float:
    """Return the value that a checkpoint displays at time `now` (s) if no fault changes it.

    Args:
        checkpoint: the checkpoint; the value is in its unit.
        first: the value displayed at 0 s.
        profile: how the value changes over time.
        seed: seed of the run, which draws the noise.
        now: time in s.
    """
    value = first + profile.drift * now / 3600.0
    value += math.fsum(step.change for step in profile.steps if step.at <= now)
    if profile.noise:
        # The noise depends on the time alone, so that other readings do not change it.
        rng = generator(seed, "value", checkpoint.id, round(1000 * now))
        value += profile.noise * float(rng.standard_normal())
    scale = checkpoint.range
    return round(min(max(value, scale.low), scale.high), 3)


@dataclass(frozen=True)
class RunSetup:
    """Run setup: the world and the robot's parts with which a mission is carried out."""

    world: AnyWorld
    navigator: Navigator
    drive: Drive
    sensor: Sensor
    watches: tuple[Watch, ...] = ()
    """watches that notice anomalies"""
    battery: Battery | None = None
    """battery of the robot; None: its power never ends"""
    schedule: FaultSchedule | None = None
    """schedule of the faults; None: there are none"""
    instruments: Instruments | None = None
    """displays of values that change over time; None: the values are constant"""

    def read_checkpoint(self, checkpoint_id: int, now: float) -> Measurement:
        """Read the checkpoint at time `now` (s) from the robot's pose.

        Raises MeasurementError if the sensor can't read it.
        """
        if self.instruments is not None:
            self.instruments.update_displayed_value(checkpoint_id, now)
        return self.sensor.measure(checkpoint_id, self.drive.pose)

    @property
    def has_simulated_world(self) -> bool:
        """True if there is a simulated world of bodies and signals for the watches."""
        return isinstance(self.world, World)


def make_run_setup(spec: RunSpec, navigator: Navigator, gui: bool, stack: ExitStack) -> RunSetup:
    """Make the run setup for a spec that was checked.

    Args:
        spec: the spec of the run.
        navigator: the navigator of the site.
        gui: whether the world is shown in a window.
        stack: exit stack that closes the world, if there is one.

    Raises:
        ArgoError: there can be no window.
    """
    site, robot, seed = navigator.site, navigator.robot, spec.seed
    truth = true_values(site, seed, spec.values)
    faults = resolve_faults(spec.faults, site, seed)
    surroundings = Surroundings(site)
    world: AnyWorld
    watches: tuple[Watch, ...] = ()
    if spec.drive == ROUTE:
        if gui:
            raise Invalid(
                Message("the drive `{drive}` has no world to show in a window", drive=spec.drive)
            )
        world = WorldWithoutPhysics(site, robot)
        inner: Drive = RouteDrive(robot)
        camera: Sensor = IdealSensor(world, robot, truth)
    else:
        real = site_with_faults(site, faults).elements
        is_drawn = spec.sensor != IDEAL  # other sensors take pictures
        world = stack.enter_context(World(site, robot, gui, real, is_drawn))
        inner = WORLD_DRIVES[spec.drive](world, robot, spec.conditions.friction)
        camera = SENSORS[spec.sensor](world, truth, seed)
        watches = standard_watches(world, surroundings, seed)
        for id, value in truth.items():
            world.show_value(id, value)
    conditions = spec.conditions
    drive, network, battery = (
        Powertrain(inner, conditions.speed),
        RadioNetwork(site),
        Battery(robot),
    )
    battery.scale_capacity_and_energy(conditions.capacity)
    battery.charge = 1.0 if conditions.charge is None else conditions.charge
    sensor = SensorWithFaults(camera, site, seed, conditions.sensor_noise)
    targets = FaultTargets(world, truth, surroundings, drive, sensor, battery, network)
    level = next((r.battery_below for r in spec.mission.reactions if r.battery_below), None)
    watches += onboard_watches(robot, battery, network, drive, sensor, level)
    instruments = Instruments(targets, site, seed, conditions.values)
    schedule = FaultSchedule(faults, targets)
    return RunSetup(world, navigator, drive, sensor, watches, battery, schedule, instruments)


def check_spec(spec: RunSpec, site: Site, fault_text: FaultText | None = None) -> None:
    """Raise ArgoError for a spec that no run on the site can have, whatever its mission is.

    `fault_text` is the text from which the faults were read; with it, errors in faults name lines
    of that text.
    """
    if fault_text:
        fault_text.require_fit(site, spec.seed)
    if spec.drive not in drive_names():
        raise Invalid(
            Message(
                "no drive `{drive}`; there are: {names}",
                drive=spec.drive,
                names=Listing(drive_names()),
            )
        )
    if spec.sensor not in SENSORS:
        raise Invalid(
            Message(
                "no sensor `{sensor}`; there are: {sensors}",
                sensor=spec.sensor,
                sensors=Listing(SENSORS),
            )
        )
    if spec.drive == ROUTE and spec.sensor != IDEAL:
        raise Invalid(
            Message(
                "the drive `{drive}` has no world that the sensor `{sensor}` could look "
                "at; choose the sensor `{ideal}` or another drive",
                drive=spec.drive,
                sensor=spec.sensor,
                ideal=IDEAL,
            )
        )
    if spec.drive != ROUTE:
        require_pybullet()
        WORLD_DRIVES.require(spec.drive)
        SENSORS.require(spec.sensor)
    true_values(site, spec.seed, spec.values)
    for id in spec.conditions.values:
        site.checkpoint(id)
    if not fault_text:
        resolve_faults(spec.faults, site, spec.seed)
    unseen = [f.kind for f in spec.faults if f.needs_world]
    if spec.drive == ROUTE and unseen:
        raise Invalid(
            Message(
                "the drive `{drive}` has no world in which a fault like `{unseen}` could "
                "be found; choose another drive",
                drive=spec.drive,
                unseen=unseen[0],
            )
        )


def true_values(site: Site, seed: int, given: Mapping[int, float]) -> dict[int, float]:
    """Return each checkpoint's true value in its unit, by number: given, or drawn by the seed.

    Raises NotFound for a checkpoint that the site does not have, Invalid for a value beyond its
    scale.
    """
    truth = draw_nominal_values(site, np.random.default_rng(seed))
    for id, value in given.items():
        checkpoint = site.checkpoint(id)
        if not checkpoint.range.contains(value):
            raise Invalid(
                Message(
                    "checkpoint {id} ({checkpoint}) shows {low:g} to {high:g} {unit}, not "
                    "{value:g}",
                    id=id,
                    checkpoint=checkpoint.name,
                    low=checkpoint.range.low,
                    high=checkpoint.range.high,
                    unit=checkpoint.unit,
                    value=value,
                )
            )
        truth[id] = value
    return truth
