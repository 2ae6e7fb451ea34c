"""What a person does with the robot while they have it."""

from collections.abc import Sequence

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.hfsm import ByHand
from argo_compiler.il import Action, Mission, Task
from argo_env.run.simulation import Simulation
from argo_planner.service.runs import requests as asked

_FREE = ("drive by hand", "measure by hand")


class SupervisedRun:
    """A run that a person may take over. Holds what they have skipped since they did."""

    def __init__(self, simulation: Simulation, skipped: Sequence[str]) -> None:
        """`skipped`: before its process died; it counts if they have the robot still."""
        self._simulation = simulation
        self._skipped = [*skipped] if simulation.taken_over else []

    @property
    def skipped(self) -> tuple[str, ...]:
        """The tasks whose next visit is left out when the robot is given back."""
        return tuple(self._skipped)

    def skip(self, name: str) -> None:
        """Leaves out the next visit of a task. Raises Conflict if nobody has the robot or that is
        skipped already, NotFound for what can't be skipped."""
        if not self._simulation.taken_over:
            raise Conflict("a task is skipped by a person who has the robot: take it over first")
        task = self._simulation.spec.mission.task(name)
        if task is None or task.action is Action.START:
            raise NotFound(f"the mission has no task '{name}' that could be skipped")
        if name in self._skipped:
            raise Conflict(
                f"the next visit of '{name}' is skipped already; it is left out when the robot is "
                "given back"
            )
        self._skipped.append(name)

    def done(self, mission: Mission) -> tuple[ByHand, ...]:
        """What was done by hand and skipped until now, for the mission, which may be edited: what
        only has the name of a skipped task, and is another one, is not skipped."""
        old = self._simulation.spec.mission
        skipped = (name for name in self._skipped if _same(old.task(name), mission.task(name)))
        left_out = (ByHand(task=name, skipped=True) for name in skipped)
        return (*self._simulation.done_by_hand, *left_out)

    def forget(self) -> None:
        """The robot was given back."""
        self._skipped.clear()

    def task(self, request: asked.DoTask | asked.DriveTo | asked.MeasureAt) -> Task:
        """What the robot is to do by hand. Raises NotFound for a task that there is not."""
        mission = self._simulation.spec.mission
        if isinstance(request, asked.DoTask):
            task = mission.task(request.task)
            if task is None:
                raise NotFound(f"the mission has no task '{request.task}'")
            return task
        drive = isinstance(request, asked.DriveTo)
        name = _FREE[0 if drive else 1]
        while mission.task(name) is not None:
            name += "'"
        if isinstance(request, asked.DriveTo):
            return Task(name=name, action=Action.WAYPOINT, pose=request.pose)
        return Task(name=name, action=Action.MEASURE, object_id=request.checkpoint)


def _same(old: Task | None, new: Task | None) -> bool:
    """Whether a task was not made anew under the same name. One that is gone is told as such."""
    if old is None or new is None:
        return True
    return (old.action, old.object_id, old.pose) == (new.action, new.object_id, new.pose)
