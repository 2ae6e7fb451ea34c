"""The recorder: all that Foxglove shows of a run, and all that a report is made from."""

import json
import logging
import math
import os
from collections.abc import Callable
from pathlib import Path

from foxglove_schemas_protobuf.Log_pb2 import Log

from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_compiler.hfsm import Occurred
from argo_compiler.il import Action, EventKind
from argo_env.navigation import Path as Way
from argo_env.recording import messages, scene
from argo_env.recording.motion import Limbs, MotionTopics, write_shot
from argo_env.recording.output import VERSION
from argo_env.recording.topic_writer import TopicWriter
from argo_env.recording.writer import media_type
from argo_env.report.files import to_json
from argo_env.robot.robot_model import read_model
from argo_env.robot.spec import robot_folder
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import Anomaly, Contact, Reading, RunRecord, TaskRun, TraceStep
from argo_env.run.robot import RobotAction
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec
from argo_env.run.verdict_line import Tone
from argo_env.site import Site, SiteCheckpoint
from argo_env.world.world import Shot, World

_log = logging.getLogger(__name__)


class MissionState(Model):
    """How the mission stands."""

    task: str | None = None
    """whose action is under way; absent: none is"""
    action: Action | None = None
    object_id: str | None = None
    states: tuple[str, ...]
    """ids of the active states, from the mission to the leaf, then the reaction's"""
    groups: tuple[str, ...]
    """names of the active groups, the outermost first"""
    rounds: tuple[int, ...]
    """which round, from 1, each of these groups is in"""
    paused: bool
    reaction: EventKind | None = None
    """the event whose reaction is active"""
    outcome: str | None = None
    """how the mission has ended"""
    done: int
    """actions that have ended as planned"""
    readings: int
    abnormal: int
    """readings outside the nominal range"""


class BatteryState(Model):
    """How the battery stands."""

    charge: float
    """0 to 1"""
    voltage: float
    """V, under the present load"""
    current: float
    """A; less than 0 while it is charged"""


def mission_state(machine: Machine, done: int, readings: int, abnormal: int) -> MissionState:
    """How the mission stands, as its machine tells it, with what has been done."""
    running = machine.running
    return MissionState(
        task=running.name if running else None,
        action=running.action if running else None,
        object_id=running.object_id if running else None,
        states=machine.configuration,
        groups=tuple(machine.rounds),
        rounds=tuple(machine.rounds.values()),
        paused=machine.paused,
        reaction=machine.reaction,
        outcome=machine.outcome,
        done=done,
        readings=readings,
        abnormal=abnormal,
    )


_LEVELS = {Tone.GOOD: Log.INFO, Tone.NOTICE: Log.WARNING, Tone.BAD: Log.ERROR}
SAMPLE_PERIOD = 0.1
"""s between recorded poses, at least; a drive with longer steps has one at each"""


class RunRecorder(Observer):
    """Writes one run. Holds what was last written, to write what is new only."""

    def __init__(
        self,
        writer: TopicWriter,
        source: Path | None = None,
        warn: Callable[[str], None] = _log.warning,
    ) -> None:
        """`source`: the file that the mission was read from; `warn` is told if it is left out."""
        self._writer = writer
        self._source = source
        self._warn = warn
        self._begun = False
        self._setup: RunSetup | None = None
        self._motion: MotionTopics | None = None
        self._next = -math.inf  # s, when the next pose is due
        self._now = 0.0
        self._sampled = -math.inf
        self._way: Way | None = None
        self._state: MissionState | None = None
        self._traced = 0
        self._done = 0
        self._readings: list[Reading] = []
        self._found: list[Anomaly] = []
        self._shots: list[Shot] = []
        self._latest: dict[int, Reading] = {}
        self._drawn: list[SiteCheckpoint] = []

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:
        """Writes what does not change: what the run is made from, the site and the robot."""
        site, robot = setup.navigator.site, setup.navigator.robot
        path = robot_folder() / robot.urdf
        model = read_model(path)
        self._setup = setup
        self._writer.describe(
            "argo",
            {
                "version": VERSION,
                "argo": __version__,
                "time": "nanoseconds of simulated time since the mission's start",
                "site": site.name,
                "robot": robot.name,
                "drive": setup.drive.name,
                "sensor": setup.sensor.name,
                "seed": str(spec.seed),
            },
        )
        attach = self._writer.attach
        for name, content in self._sources().items():
            attach(f"source/{name}", media_type(Path(name)), content)
        attach("mission.json", "application/json", spec.mission.model_dump_json(indent=2))
        attach("settings.json", "application/json", json.dumps(spec.settings, indent=2))
        attach("site.json", "application/json", site.spec.model_dump_json(indent=2))
        attach(path.name, "application/xml", model.text)
        for number, update in scene.site_scenes(_as_it_is(setup), 0.0).items():
            self._writer.put(f"/site/floor_{number}", update, 0.0)
        self._writer.put("/robot", scene.robot_scene(model, 0.0), 0.0)
        self._draw_checkpoints(0.0)
        self._motion = MotionTopics(self._writer, model, _limbs(setup))
        self._motion.begin(0.0)
        if isinstance(setup.world, World):
            # They are written at the end of the step in which they were taken.
            setup.world.on_shot = self._shots.append
        self._writer.flush(0.0)
        self._begun = True

    def on_step(self, now: float, action: RobotAction | None) -> None:
        """Writes the robot's motion, and the way ahead when there is a new one."""
        self._now = now
        for shot in self._shots:
            write_shot(self._writer, shot, now)
        self._shots.clear()
        if now < self._next - 1e-9:
            return
        self._sample(now)
        # Counted from 0, so that steps that do not divide the period make no drift.
        self._next = (math.floor(now / SAMPLE_PERIOD + 1e-6) + 1) * SAMPLE_PERIOD
        if action is not None and action.path is not None and action.path is not self._way:
            self._way = action.path
            poses = (action.path.start, *(motion.end for motion in action.path.motions))
            self._writer.put("/path", messages.path(poses, now), now)
        self._writer.flush_if_due(now)

    def on_change(self, entry: Entry, machine: Machine) -> None:
        """Writes what has happened, and how the mission stands now."""
        if self._sampled == -math.inf:
            self.on_step(entry.t, None)
        now = self._now = entry.t
        for event in entry.events:
            original = event.to_event()
            if isinstance(original, Occurred):
                detail = f": {original.detail}" if original.detail else ""
                self._log(f"{original.event.replace('_', ' ')}{detail}", Log.WARNING, "event", now)
        assert self._setup is not None, "on_begin comes first"
        found = (*entry.found, *entry.reported_anomalies(self._setup.navigator.site))
        for anomaly in found:
            self._found.append(anomaly)
            self._writer.put_json("/findings", anomaly, now)
        if found:
            self._writer.put("/findings/markers", scene.finding_scene(self._found, now), now)
        for told in entry.given_values(self._setup.navigator.site):
            self._log(told.in_words, Log.INFO, "told", now)
        for mishap in entry.mishaps:
            self._log(f"{mishap.trouble}: {mishap.detail}", Log.WARNING, "drive", now)
        for contact in entry.contacts:
            self._contact(contact, now)
        if entry.reading:
            self._reading(entry.reading)
        if entry.task:
            self._task(entry.task)
        if entry.sample:
            self._battery(now)
        if entry.stopped:
            self._log(entry.stopped, Log.ERROR, "run", now)
        if entry.events or entry.resumed or entry.ended or self._state is None:
            self._mission(machine, now)

    def on_interrupted(self, record: RunRecord) -> None:
        """Writes the record as it stands; that of a later moment counts more."""
        self.on_end(record)

    def on_end(self, record: RunRecord) -> None:
        """Writes the end of the run and its record."""
        headline, now = record.headline, self._now
        if now != self._sampled:
            self._sample(now)
        self._log(str(headline), _LEVELS[headline.tone], "verdict", now)
        self._writer.attach("record.json", "application/json", to_json(record), now)

    def close(self) -> None:
        """Writes the index of the file."""
        self._writer.close()

    @property
    def until(self) -> float | None:
        """s of simulated time up to which all can be read, whatever happens; None: nothing can."""
        return self._writer.until if self._begun else None

    def give_up(self) -> None:
        """Keeps nothing any more of what there is to record."""
        self._shots.clear()
        if self._setup is not None and isinstance(self._setup.world, World):
            self._setup.world.on_shot = None

    def _sources(self) -> dict[str, bytes]:
        """The file that the mission was read from, or the files of its folder, by their names."""
        source = self._source
        if source is None:
            return {}
        try:
            if os.path.isdir(source):
                return {f"{source.name}/{p.name}": p.read_bytes() for p in sorted(source.iterdir())}
            if os.path.isfile(source):
                return {source.name: source.read_bytes()}
            why = "it is no file that can be read again"
        except OSError as error:
            why = str(error.strerror)
        self._warn(f"{source}: is not recorded with the run: {why}")
        return {}

    def _sample(self, now: float) -> None:
        assert self._setup is not None, "on_begin comes first"
        assert self._motion is not None
        self._sampled = now
        self._motion.sample(self._setup.drive.pose, now)
        if self._checkpoints() != self._drawn:
            self._draw_checkpoints(now)

    def _checkpoints(self) -> list[SiteCheckpoint]:
        """The checkpoints where they really are."""
        assert self._setup is not None
        world = self._setup.world
        return [world.actual_checkpoint(c.id) for c in world.site.checkpoints]

    def _draw_checkpoints(self, now: float) -> None:
        self._drawn = self._checkpoints()
        update = scene.checkpoint_scene(self._drawn, self._latest, now)
        self._writer.put("/checkpoints", update, now)

    def _mission(self, machine: Machine, now: float) -> None:
        for e in machine.trace[self._traced :]:
            self._traced += 1
            step = TraceStep(t=e.time, source=e.source, target=e.target, cause=e.why)
            self._writer.put_json("/trace", step, now)
        abnormal = sum(not reading.normal for reading in self._readings)
        state = mission_state(machine, self._done, len(self._readings), abnormal)
        if state != self._state:
            self._state = state
            self._writer.put_json("/mission", state, now)

    def _battery(self, now: float) -> None:
        battery = self._setup.battery if self._setup else None
        if battery is not None:
            state = BatteryState(
                charge=battery.charge, voltage=battery.voltage, current=battery.current
            )
            self._writer.put_json("/battery", state, now)

    def _reading(self, reading: Reading) -> None:
        self._readings.append(reading)
        self._latest[reading.checkpoint] = reading
        self._writer.put_json("/readings", reading, reading.t)
        self._draw_checkpoints(reading.t)
        self._log(
            f"{reading.name} (#{reading.checkpoint}) shows {reading.value:.4g} {reading.unit}, "
            f"{'normal' if reading.normal else 'abnormal'}",
            Log.INFO if reading.normal else Log.WARNING,
            "reading",
            reading.t,
        )

    def _task(self, task: TaskRun) -> None:
        self._done += task.outcome == "done" and not task.by_hand
        self._writer.put_json("/tasks", task, task.end)
        level = {"done": Log.INFO, "failed": Log.ERROR}.get(task.outcome, Log.WARNING)
        because = f": {task.reason}" if task.reason else ""
        self._log(f"{task.task} {task.outcome_in_words}{because}", level, "task", task.end)

    def _contact(self, contact: Contact, now: float) -> None:
        self._writer.put_json("/contacts", contact, now)
        self._log(f"{contact.link} touches {contact.element}", Log.WARNING, "contact", now)

    def _log(self, text: str, level: "Log.Level.ValueType", name: str, now: float) -> None:
        self._writer.put("/log", messages.log(text, level, name, now), now)


def _as_it_is(setup: RunSetup) -> Site:
    """The site with what faults have put into the way, and without what they have taken away."""
    site, world = setup.navigator.site, setup.world
    if not isinstance(world, World):
        return site
    return site.with_elements(tuple(e for e in world.solids if e.solids))


def _limbs(setup: RunSetup) -> Limbs:
    """Where the robot's joints are; on paper its arm is stowed and its flippers are level."""
    world = setup.world
    if isinstance(world, World):
        return world.joint_positions
    stowed = {name: math.radians(a) for name, a in setup.navigator.robot.arm_stowed.items()}
    return lambda names: [stowed.get(name, 0.0) for name in names]
