"""Recorder of a run: it writes the topics for Foxglove and the data from which a report is made."""

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
from argo_env.navigation import Path as RobotPath
from argo_env.recording import messages, scene
from argo_env.recording.motion import JointPositions, MotionTopics, write_shot
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
    """State of the mission at a moment."""

    task: str | None = None
    """task whose action is under way; absent if there is none"""
    action: Action | None = None
    object_id: str | None = None
    states: tuple[str, ...]
    """ids of the active states, from the mission to the leaf, then the reaction's"""
    groups: tuple[str, ...]
    """names of the active groups, the outermost first"""
    rounds: tuple[int, ...]
    """present round of each of these groups, from 1"""
    paused: bool
    reaction: EventKind | None = None
    """event whose reaction is active"""
    outcome: str | None = None
    """outcome of the mission; absent until it has ended"""
    done: int
    """number of actions that the robot has ended as planned"""
    readings: int
    """number of readings"""
    abnormal: int
    """number of readings outside the nominal range"""


class BatteryState(Model):
    """State of the battery at a moment."""

    charge: float
    """charge, 0 to 1"""
    voltage: float
    """voltage in V, under the present load"""
    current: float
    """current in A; less than 0 while the battery is charged"""


def make_mission_state(machine: Machine, done: int, readings: int, abnormal: int) -> MissionState:
    """Return the state of the mission, from its machine and the counts so far.

    The counts are of the tasks done, the readings, and the abnormal ones of these.
    """
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
"""time in s between recorded poses; a drive with longer steps has one at each step"""


class RunRecorder(Observer):
    """Observer that writes one run; it holds the last written data to write only changes."""

    def __init__(
        self,
        writer: TopicWriter,
        source: Path | None = None,
        warn: Callable[[str], None] = _log.warning,
    ) -> None:
        """Take the writer and the options of the recording.

        Args:
            writer: writer of the topics.
            source: file or folder that the mission was read from, to be stored as well.
            warn: function that is called with a warning if the source can't be stored.
        """
        self._writer = writer
        self._source = source
        self._warn = warn
        self._begun = False
        self._setup: RunSetup | None = None
        self._motion: MotionTopics | None = None
        self._next = -math.inf  # s, when the next pose is due
        self._now = 0.0
        self._sampled_at = -math.inf
        self._path: RobotPath | None = None
        self._state: MissionState | None = None
        self._traced = 0  # number of written steps of the state machine
        self._done = 0
        self._readings: list[Reading] = []
        self._anomalies: list[Anomaly] = []
        self._shots: list[Shot] = []
        self._latest: dict[int, Reading] = {}
        self._drawn: list[SiteCheckpoint] = []

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:
        """Write all data that do not change: the inputs of the run, the site and the robot."""
        site, robot = setup.navigator.site, setup.navigator.robot
        path = robot_folder() / robot.urdf
        model = read_model(path)
        self._setup = setup
        self._writer.write_metadata(
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
        for number, update in scene.site_scenes(_actual_site(setup), 0.0).items():
            self._writer.put(f"/site/floor_{number}", update, 0.0)
        self._writer.put("/robot", scene.robot_scene(model, 0.0), 0.0)
        self._draw_checkpoints(0.0)
        self._motion = MotionTopics(self._writer, model, _joint_positions(setup))
        self._motion.write_fixed_transforms(0.0)
        if isinstance(setup.world, World):
            # Pictures are written at the end of the step in which they are taken.
            setup.world.on_shot = self._shots.append
        self._writer.flush(0.0)
        self._begun = True

    def on_step(self, now: float, action: RobotAction | None) -> None:
        """Write the step's pictures and, every `SAMPLE_PERIOD`, the robot's pose.

        The planned path is written with the pose if it is another one than before.
        """
        self._now = now
        for shot in self._shots:
            write_shot(self._writer, shot, now)
        self._shots.clear()
        if now < self._next - 1e-9:
            return
        self._write_sample(now)
        # Multiples of the period avoid a drift if the steps do not divide it.
        self._next = (math.floor(now / SAMPLE_PERIOD + 1e-6) + 1) * SAMPLE_PERIOD
        if action is not None and action.path is not None and action.path is not self._path:
            self._path = action.path
            poses = (action.path.start, *(motion.end for motion in action.path.motions))
            self._writer.put("/path", messages.make_path(poses, now), now)
        self._writer.flush_if_due(now)

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:
        """Write the contents of the entry and, if it has changed, the state of the mission."""
        if self._sampled_at == -math.inf:
            self.on_step(entry.t, None)
        now = self._now = entry.t
        for event in entry.events:
            original = event.to_event()
            if isinstance(original, Occurred):
                detail = f": {original.detail}" if original.detail else ""
                self._log(f"{original.event.replace('_', ' ')}{detail}", Log.WARNING, "event", now)
        assert self._setup is not None, "on_begin comes first"
        anomalies = (
            *entry.found,
            *entry.anomalies_reported_from_outside(self._setup.navigator.site),
        )
        for anomaly in anomalies:
            self._anomalies.append(anomaly)
            self._writer.put_json("/findings", anomaly, now)
        if anomalies:
            self._writer.put("/findings/markers", scene.finding_scene(self._anomalies, now), now)
        for value in entry.values_from_people(self._setup.navigator.site):
            self._log(value.in_words, Log.INFO, "told", now)
        for mishap in entry.mishaps:
            self._log(f"{mishap.trouble}: {mishap.detail}", Log.WARNING, "drive", now)
        for contact in entry.contacts:
            self._write_contact(contact, now)
        if entry.reading:
            self._write_reading(entry.reading)
        if entry.task:
            self._write_task(entry.task)
        if entry.sample:
            self._write_battery(now)
        if entry.stopped:
            self._log(str(entry.stopped), Log.ERROR, "run", now)
        if entry.events or entry.resumed or entry.ended or self._state is None:
            self._write_mission(machine, now)

    def on_interrupted(self, record: RunRecord) -> None:
        """Write the record so far; a reader takes the last record of a recording."""
        self.on_end(record)

    def on_end(self, record: RunRecord) -> None:
        """Write the end of the run and its record."""
        headline, now = record.headline, self._now
        if now != self._sampled_at:
            self._write_sample(now)
        self._log(str(headline), _LEVELS[headline.tone], "verdict", now)
        self._writer.attach("record.json", "application/json", to_json(record), now)

    def complete_without_closing(self) -> None:
        """Complete the recording: the writer writes what is pending and, in a file, the index."""
        self._writer.complete_without_closing()

    @property
    def readable_until(self) -> float | None:
        """Time in s up to which all stays readable if the process dies; None: nothing does."""
        return self._writer.readable_until if self._begun else None

    def discard_pending_and_further_pictures(self) -> None:
        """Discard the pictures that are not written yet, and receive no more from the world."""
        self._shots.clear()
        if self._setup is not None and isinstance(self._setup.world, World):
            self._setup.world.on_shot = None

    def _sources(self) -> dict[str, bytes]:
        """Return the file that the mission was read from, or the files of its folder, by name."""
        source = self._source
        if source is None:
            return {}
        try:
            if os.path.isdir(source):
                return {f"{source.name}/{p.name}": p.read_bytes() for p in sorted(source.iterdir())}
            if os.path.isfile(source):
                return {source.name: source.read_bytes()}
            reason = "it is not a file that can be read again"
        except OSError as error:
            reason = str(error.strerror)
        self._warn(f"{source} is not recorded with the run: {reason}")
        return {}

    def _write_sample(self, now: float) -> None:
        assert self._setup is not None, "on_begin comes first"
        assert self._motion is not None
        self._sampled_at = now
        self._motion.write_sample(self._setup.drive.pose, now)
        if self._actual_checkpoints() != self._drawn:
            self._draw_checkpoints(now)

    def _actual_checkpoints(self) -> list[SiteCheckpoint]:
        """Return the checkpoints at their actual poses, to which faults may have moved them."""
        assert self._setup is not None
        world = self._setup.world
        return [world.actual_checkpoint(c.id) for c in world.site.checkpoints]

    def _draw_checkpoints(self, now: float) -> None:
        self._drawn = self._actual_checkpoints()
        update = scene.checkpoint_scene(self._drawn, self._latest, now)
        self._writer.put("/checkpoints", update, now)

    def _write_mission(self, machine: Machine, now: float) -> None:
        for e in machine.trace[self._traced :]:
            self._traced += 1
            step = TraceStep(t=e.time, source=e.source, target=e.target, cause=e.why)
            self._writer.put_json("/trace", step, now)
        abnormal = sum(not reading.normal for reading in self._readings)
        state = make_mission_state(machine, self._done, len(self._readings), abnormal)
        if state != self._state:
            self._state = state
            self._writer.put_json("/mission", state, now)

    def _write_battery(self, now: float) -> None:
        battery = self._setup.battery if self._setup else None
        if battery is not None:
            state = BatteryState(
                charge=battery.charge, voltage=battery.voltage, current=battery.current
            )
            self._writer.put_json("/battery", state, now)

    def _write_reading(self, reading: Reading) -> None:
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

    def _write_task(self, task: TaskRun) -> None:
        self._done += task.outcome == "done" and not task.by_hand
        self._writer.put_json("/tasks", task, task.end)
        level = {"done": Log.INFO, "failed": Log.ERROR}.get(task.outcome, Log.WARNING)
        reason = f": {task.reason}" if task.reason else ""
        self._log(f"{task.task} {task.outcome_in_words}{reason}", level, "task", task.end)

    def _write_contact(self, contact: Contact, now: float) -> None:
        self._writer.put_json("/contacts", contact, now)
        self._log(f"{contact.link} touches {contact.element}", Log.WARNING, "contact", now)

    def _log(self, text: str, level: "Log.Level.ValueType", name: str, now: float) -> None:
        self._writer.put("/log", messages.make_log(text, level, name, now), now)


def _actual_site(setup: RunSetup) -> Site:
    """Return the site with the elements that faults have added, without those they have removed."""
    site, world = setup.navigator.site, setup.world
    if not isinstance(world, World):
        return site
    return site.replacing_elements(tuple(e for e in world.solids if e.solids))


def _joint_positions(setup: RunSetup) -> JointPositions:
    """Return the function that gives the positions of the robot's joints.

    Without physics, its arm is stowed and its flippers are level.
    """
    world = setup.world
    if isinstance(world, World):
        return world.joint_positions
    stowed = {name: math.radians(a) for name, a in setup.navigator.robot.arm_stowed.items()}
    return lambda names: [stowed.get(name, 0.0) for name in names]
