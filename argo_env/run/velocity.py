"""The velocity of a way: that of the task that the robot comes from (thesis 3.2)."""

from argo_compiler.il import Action, Mission, Task
from argo_compiler.il.reserved import RESERVED_NAMES


class WayVelocity:
    """Tells the velocity (m/s) of each way. Holds the task that the robot is on its way to."""

    def __init__(self, mission: Mission) -> None:
        starts = [t.velocity for t in mission.tasks if t.action is Action.START]
        self._velocity = starts[0] if starts else None
        self._task: Task | None = None
        self._done = False

    def to(self, task: Task) -> float | None:
        """That of the way to `task`, which is started now; None: the robot's own speed.

        A task that is started anew before it was done still lies ahead. The drive of a reaction is
        no part of the plan.
        """
        if task.name in RESERVED_NAMES:
            return None
        if self._task is not None and (self._done or task.name != self._task.name):
            self._velocity = self._task.velocity
        self._task, self._done = task, False
        return self._velocity

    def arrived(self, task_name: str) -> None:
        """Takes note that the task has been done."""
        if self._task is not None and task_name == self._task.name:
            self._done = True
