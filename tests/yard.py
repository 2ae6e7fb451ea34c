"""The yard: a small site and missions, loaded and run in a second or two."""

from contextlib import contextmanager
from itertools import pairwise

import yaml

from argo_compiler.base.model import Pose
from argo_compiler.files.mission_file import write_mission
from argo_compiler.hfsm import TakeOver, lower
from argo_compiler.il import (
    Action,
    Afterwards,
    EventKind,
    Mission,
    Reaction,
    Response,
    Task,
    Transition,
)
from argo_env.drives.drive import DriveStatus
from argo_env.faults.kinds import FaultFile
from argo_env.files.checked_lines import parse_lines
from argo_env.navigation import Navigator
from argo_env.planning.opening import OpenedSite
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import load_robot
from argo_env.run.initial_state import make_machine
from argo_env.run.journal import Header, create_journal, open_journal
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.run_setup import RunSetup
from argo_env.run.session import resume, simulate
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec, logged_events
from argo_env.sensing.sensor import Measurement
from argo_env.site import make_site
from argo_env.site.spec import SiteSpec

SITE = {
    "name": "yard",
    "title": "Yard",
    "storey": 2.5,
    "ground": [0, 0, 7, 5],
    "ground_z": 0.0,
    "towers": [],
    "areas": [{"number": 1, "dock": [1.05, 1.05, 0]}],
    "floors": [
        {
            "number": 1,
            "z": 0.02,
            "railed": False,
            "walkways": {"slab": [0.5, 0.5, 6.5, 4.5]},
            "checkpoints": [
                {
                    "id": k,
                    "kind": "pressure gauge",
                    "name": f"gauge {k}",
                    "position": [x, y, 0.8],
                    "yaw": yaw,
                    "nominal": {"low": 2, "high": 5},
                }
                for k, (x, y, yaw) in enumerate([(2.5, 4.4, -90), (4.5, 4.4, -90), (5, 0.6, 90)], 1)
            ],
        }
    ],
}


AWAY_FROM_THE_EDGE = [{"number": 1, "dock": [2.05, 2.05, 0]}]
"""areas, so that the robot turns in its dock"""


def site_of(**changes):
    """Return the yard's site, with `changes` of its fields."""
    return make_site(SiteSpec.model_validate(SITE | changes))


def write_site(path, **changes):
    """Write the yard's site, with `changes`, to a file, and return the path as text."""
    path.write_text(yaml.safe_dump(SITE | changes), encoding="utf-8")
    return str(path)


def write_yard(folder, **missions):
    """Write the site as `yard.yaml`, and missions by name, to a folder."""
    write_site(folder / "yard.yaml")
    for name, plan in missions.items():
        write_mission(plan, folder / f"{name}.json")


def gauged(low, high):
    """Return the yard's site with gauges of this nominal range."""
    (floor,) = SITE["floors"]
    checkpoints = [c | {"nominal": {"low": low, "high": high}} for c in floor["checkpoints"]]
    return site_of(floors=[floor | {"checkpoints": checkpoints}])


def yard():
    navigator = Navigator(site_of(), load_robot())
    navigator.prepare()
    return navigator


def measure(id, **fields):
    return Task(name=f"MEASURE {id}", action=Action.MEASURE, object_id=str(id), **fields)


def waypoint(name, x, y, **fields):
    return Task(name=name, action=Action.WAYPOINT, pose=Pose(x=x, y=y, z=0.02), **fields)


def in_order(*tasks):
    """Return the tasks linked in order, where they have no transitions of their own."""
    linked = [
        a if a.transitions else a.model_copy(update={"transitions": (Transition(target=b.name),)})
        for a, b in pairwise(tasks)
    ]
    return (*linked, tasks[-1])


def from_place(pose, *tasks, **fields):
    """Return a mission of the tasks in order that starts at a pose."""
    start = Task(name="START", action=Action.START, pose=pose)
    return Mission(tasks=in_order(start, *tasks), **fields)


def mission(*tasks, **fields):
    """Return a mission of the tasks in order that starts in the dock of the yard."""
    return from_place(Pose(x=1.05, y=1.05, z=0.02), *tasks, site="yard", **fields)


def shelter(x, y):
    """Return a reaction to gas: wait at a safe place for ALL_CLEAR, then resume."""
    return Reaction(
        event=EventKind.GAS_LEAK,
        response=Response.SAFE_AREA,
        pose=Pose(x=x, y=y, z=0.02),
        until=EventKind.ALL_CLEAR,
        afterwards=Afterwards.RESUME,
    )


class GlidingDrive:
    """Drive that follows paths at the planned speeds, without a world below it."""

    name = "gliding"
    time_step = 0.1
    failure = None
    incidents = ()

    def __init__(self, robot):
        self._robot = robot
        self._left, self._elapsed, self._velocity = [], 0.0, None
        self.pose = None
        self.velocities = []

    def place_robot(self, pose):
        self.pose, self._left = pose, []

    def follow(self, path, velocity):
        self._left, self._elapsed, self._velocity = list(path.motions), 0.0, velocity
        self.velocities.append(velocity)

    def halt(self):
        self._left = []

    def step(self):
        self._elapsed += self.time_step
        while self._left:
            motion = self._left[0]
            duration = motion.duration(self._robot, self._velocity)
            share = min(1.0, self._elapsed / duration) if duration else 1.0
            a, b = motion.start, motion.end
            x, y, z = (p + share * (q - p) for p, q in ((a.x, b.x), (a.y, b.y), (a.z, b.z)))
            self.pose = BodyPose(x, y, z, a.yaw + share * motion.turn)
            if share < 1.0:
                return DriveStatus.MOVING
            self._elapsed -= duration
            self._left.pop(0)
        return DriveStatus.ARRIVED


class EmptyWorld:
    """World without contacts. Stores the commands of the arm."""

    def __init__(self):
        self.arm = []

    def set_arm_degrees(self, joints):
        self.arm.append(joints)

    def touches(self):
        return ()


class Oracle:
    """Sensor that reads checkpoint k as k plus 1.5, from any pose."""

    name = "oracle"

    def __init__(self, values=None):
        self._values = values or {}

    def measure(self, checkpoint_id, _):
        return Measurement(self._values.get(checkpoint_id, 1.5 + checkpoint_id), 1.0)


def fast_setup(navigator, values=None):
    """Return a run setup without physics."""
    return RunSetup(EmptyWorld(), navigator, GlidingDrive(navigator.robot), Oracle(values))


class Entries(Observer):
    """Observer that stores the entries of a run."""

    def __init__(self):
        self.all = []

    def on_entry(self, entry):
        self.all.append(entry)


class Watching(Observer):
    """Observer that calls `observe` with time and task after each step, `announce` with news."""

    def __init__(self, observe=None, announce=None):
        self._observe, self._announce = observe, announce

    def on_entry_applied(self, entry, _):
        for news in entry.other_anomalies_then_reading if self._announce else ():
            self._announce(news)

    def on_step(self, now, action):
        if self._observe:
            self._observe(now, action.task if action else None)


def opened(navigator):
    """Return the navigator's site as an `OpenedSite`."""
    return OpenedSite.from_navigator(navigator)


def simulated(plan, navigator, *, observers=(), journal=None, gui=False, pace=None, **fields):
    """Run a mission on the navigator's site, with `fields` of the spec, and return the record."""
    site = opened(navigator)
    spec = RunSpec(mission=plan, site=site.reference, **fields)
    return simulate(spec, site, observers=observers, journal=journal, gui=gui, pace=pace)


def run_with(plan, setup, *, observers=(), journal=None, interrupted=lambda: False, **fields):
    """Run a mission with a setup, from the start or the end of a journal; return the record."""
    spec = RunSpec(mission=plan, site=setup.navigator.site.name, **fields)
    past = journal.entries if journal else ()
    if journal:
        observers = (journal, *observers)
    with simulation_of(
        spec, opened(setup.navigator), past=past, observers=observers, setup=setup
    ) as simulation:
        return simulation.run(interrupted)


def run(navigator, plan, *events, values=None):
    """Run a mission without physics, with events at their times, and return the record."""
    return run_with(plan, fast_setup(navigator, values), events=logged_events(*events))


def simulation_of(spec, site, **arguments):
    """Return a simulation of the spec's mission."""
    return Simulation(make_machine(spec.mission, spec.beginning), site, spec, **arguments)


@contextmanager
def journaled(path, spec, site, **arguments):
    """Yield a simulation with a journal; an existing journal is continued from its end."""
    known = path.exists()
    with (
        open_journal(path)
        if known
        else create_journal(path, Header.from_run(site, spec)) as journal
    ):
        past = journal.entries if known else ()
        with simulation_of(spec, site, past=past, observers=[journal], **arguments) as simulation:
            yield simulation


def record_of(mission, **fields):
    """Return an invented record of a run on UMAD, empty except for `fields`."""
    nothing = dict.fromkeys(("diagnostics", "tasks", "readings", "contacts", "trace", "path"), ())
    made_with = {"site": "umad", "robot": "tracker", "drive": "kinematic", "sensor": "ideal"}
    usual = {"mission": mission, "hfsm": lower(mission), "seed": 0}
    return RunRecord(**(usual | made_with | nothing | fields))


def faults_of(*data):
    return FaultFile.model_validate({"faults": data}).faults


def cut(journal, share=0.5, to=None):
    """Truncate a journal to a share of its lines, in place or into the file `to`."""
    lines = journal.read_bytes().splitlines(keepends=True)
    (to or journal).write_bytes(b"".join(lines[: max(2, round(share * len(lines)))]))


def cut_after(journal, entries):
    """Truncate a journal after a number of entries."""
    content = journal.read_bytes()
    journal.write_bytes(content[: parse_lines(content).objects[entries].end])


def resumed(path, navigator, **options):
    """Resume a run from its journal, and return the record."""
    with open_journal(path) as journal:
        return resume(journal, opened(navigator), **options)


def steps(simulation, count):
    for _ in range(count):
        simulation.step()


def until(simulation, reached):
    while not reached():
        simulation.step()


def to_rest(simulation):
    until(simulation, lambda: simulation.task is None or simulation.ended)


def take_over(simulation, after=0):
    """Take the robot over after some steps, and wait until it has stopped."""
    steps(simulation, after)
    simulation.handle(TakeOver())
    to_rest(simulation)
