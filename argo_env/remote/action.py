"""The action of a task that a robot somewhere else carries out."""

from collections.abc import Callable

from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded, StartAction
from argo_compiler.il import Task
from argo_env.navigation import Path
from argo_env.remote.messages import EndReport
from argo_env.run.record import DIGITS, TaskRun
from argo_env.run.rig import Rig
from argo_env.run.robot import ActionEnd


class RemoteAction:
    """Holds what was ordered, and whether it is to be cancelled."""

    path: Path | None = None
    came: Path | None = None

    def __init__(
        self,
        id: str,
        command: StartAction,
        started: float,
        way: tuple[float, float],
        cancel: Callable[[], None],
    ) -> None:
        """Its id for the robot; then when (s) and after what way (m driven, m upwards) it was
        ordered, and what orders the robot to stop it."""
        self.id = id
        self._command = command
        self._started = started
        self._way = way
        self._order_to_cancel = cancel
        self.cancelled: str | None = None
        """why it is to be cancelled, if it is"""
        self._interrupted = False

    @property
    def task(self) -> Task:
        return self._command.task

    def cancel(self, reason: str, interrupted: bool) -> None:
        """Orders the robot to stop; its report is awaited."""
        if self.cancelled is None:
            self.cancelled, self._interrupted = reason, interrupted
            self._order_to_cancel()

    def detour(self, rig: Rig) -> None:
        """The robot finds its way itself."""

    def end(self, report: EndReport, abnormal: bool) -> ActionEnd:
        """What the machine is told of the end that the robot reported."""
        name, id = self.task.name, self._command.id or None
        if report.outcome == "done":
            return ActionSucceeded(name, report.value, abnormal, id)
        if report.outcome == "stopped" and self.cancelled is not None:
            return ActionStopped(name, id)
        reason = report.reason or f"the robot reported that it has {report.outcome}"
        return ActionFailed(name, reason, report.unreadable, id)

    def run(self, end: ActionEnd, now: float, distance: float, climbed: float) -> TaskRun:
        """The action as it goes into the record."""
        reason = end.reason if isinstance(end, ActionFailed) else None
        outcome = "done"
        if not isinstance(end, ActionSucceeded):
            outcome = "interrupted" if self._interrupted else "cancelled"
            outcome = "failed" if self.cancelled is None else outcome
            reason = "; ".join(filter(None, (self.cancelled, reason))) or None
        return TaskRun(
            task=self.task.name,
            action=self.task.action,
            object_id=self.task.object_id,
            start=self._started,
            end=now,
            outcome=outcome,
            reason=reason,
            distance=round(distance - self._way[0], DIGITS),
            climbed=round(climbed - self._way[1], DIGITS),
        )
