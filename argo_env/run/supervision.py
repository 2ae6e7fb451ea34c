"""A person has the robot: what they may let it do, and what it has done for them."""

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.hfsm import ByHand
from argo_compiler.il import Action, Mission, Task
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.record import TaskRun
from argo_env.site import Site

_DRIVEN = (Action.WAYPOINT, Action.MEASURE)


class Supervision:
    """Follows the entries of a run. Holds whether a person has the robot, whether an action that
    they asked for is under way, and those that have been done."""

    def __init__(self, mission: Mission) -> None:
        self.taken_over = False
        """whether a person has taken the robot over, and not given it back"""
        self.acting = False
        """whether an action by hand is under way"""
        self._mission = mission
        self._done: list[tuple[float, ByHand]] = []

    def done(self, now: float) -> tuple[ByHand, ...]:
        """The mission's tasks done by hand since the take-over, told at time `now` (s)."""
        return tuple(one.model_copy(update={"age": now - end}) for end, one in self._done)

    def ended(self, run: TaskRun, entry: Entry) -> None:
        """An action by hand has ended."""
        self.acting = False
        if run.outcome != "done" or self._mission.task(run.task) is None:
            return
        reading = entry.reading
        done = ByHand(
            task=run.task,
            value=None if reading is None else reading.value,
            abnormal=reading is not None and not reading.normal,
            duration=run.end - run.start,
        )
        self._done.append((run.end, done))

    def heard(self, kind: str, machine: Machine) -> None:
        """The machine was told an event of that kind."""
        if kind == "take_over" and machine.paused:
            self.taken_over = True
        elif kind in ("resume", "give_back") or not machine.paused:
            self.taken_over = False
            self._done.clear()


def check_by_hand(task: Task, mission: Mission, site: Site) -> None:
    """Raises Invalid for a task that no robot carries out for a person, NotFound for a checkpoint
    that the site does not have."""
    if not isinstance(task, Task):
        raise Invalid(f"{task!r} is no task: give one that drives or measures")
    own = mission.task(task.name)
    if own is not None and own != task:
        raise Invalid(
            f"the mission has another task '{task.name}': give that one, or another name to this"
        )
    if task.action not in _DRIVEN:
        raise Invalid(
            f"task '{task.name}' is a {task.action}, for which the robot does nothing: give one "
            "that drives or measures"
        )
    if task.action is Action.MEASURE:
        site.measured_by(task.object_id)
    elif task.pose is None:
        raise Invalid(f"task '{task.name}' says not where to drive: give it a pose")


def require_supervised(supervision: Supervision, running: Task | None) -> None:
    """Raises Conflict where a person can't let the robot do anything now."""
    if running is not None:
        raise Conflict(
            f"the action of task '{running.name}' has not ended yet: stop it, or let time pass "
            "until no action runs"
        )
    if not supervision.taken_over:
        raise Conflict(
            "nobody has taken the robot over: take it over before you let it do anything by hand"
        )
