"""Gives tasks what is said of each of them: a speed, limits, a window, a priority."""

from collections.abc import Sequence

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, JointState, TimeWindow
from argo_compiler.script.resolve.locating import Locator
from argo_compiler.script.resolve.program import Do
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.manner import Joints, Manner

_FRESH = Do("", Action.MEASURE)
"""what a task has of which nothing is said"""
_MOST_PRIORITY = 1_000_000
_SHOWN = 8
"""priorities that a note names"""


class Furnishing:
    """What is said of single tasks."""

    def __init__(self, locator: Locator, diagnostics: Diagnostics) -> None:
        self.locator = locator
        self.diagnostics = diagnostics

    def furnish(self, manner: Manner, span: Span, tasks: Sequence[Do]) -> None:
        """Applies it to each of the tasks; what is said twice and differs is an error."""
        if manner.priority is not None and not 1 <= manner.priority <= _MOST_PRIORITY:
            message = f"{manner.priority} is no priority of a task"
            hint = f"write a number from 1 to {_MOST_PRIORITY}"
            self.diagnostics.refuse("number", message, span, hint)
        if manner.priority == 1:
            message = "priority 1 can be meant as the highest, or as the lowest as it is without it"
            hint = "write `with high priority`, or a greater number for what is more important"
            self.diagnostics.error("ambiguous-priority", message, span, hint)
        if manner.rank is not None and manner.priority not in (None, manner.rank):
            message = "the priority is said twice"
            self.diagnostics.error("repeated-limit", message, span, "leave one of them out")
        if manner.by_importance:
            self._by_importance(manner, span, tasks)
        given = {
            "velocity": manner.speed,
            "time_limit": manner.time_limit,
            "reading_limit": manner.reading_limit,
            "optional": manner.optional or None,
            "priority": manner.rank if manner.priority is None else manner.priority,
            "joints": _joint_state(manner.joints),
            "shown_in": manner.shown_in,
            "pose": None if manner.pose is None else self.locator.point(manner.pose),
        }
        for do in tasks:
            for name, value in given.items():
                self._set(do, name, value, span)
            self._window(do, manner, span)
            if manner.object_id is not None:
                self._about(do, manner.object_id, span)
        if tasks:
            self._set(tasks[-1], "leaving", manner.leaving, span)

    def _by_importance(self, manner: Manner, span: Span, tasks: Sequence[Do]) -> None:
        """Gives the first of the tasks the highest priority, and the last one 1."""
        if len(tasks) < 2 or manner.priority is not None or manner.rank is not None:
            message = "this is said of several tasks, of which each is less important than the last"
            hint = "write `Check checkpoints 3, 7 and 12, the most important first`"
            self.diagnostics.refuse("stray-clause", message, span, hint)
        names = ", ".join(f"`{do.base}` {len(tasks) - i}" for i, do in enumerate(tasks[:_SHOWN]))
        more = ", and so on" if len(tasks) > _SHOWN else ""
        self.diagnostics.note("priority-taken", f"taken as these priorities: {names}{more}", span)
        for i, do in enumerate(tasks):
            self._set(do, "priority", len(tasks) - i, span)

    def _set(self, do: Do, name: str, value: object, span: Span) -> None:
        if value is None:
            return
        if getattr(do, name) not in (getattr(_FRESH, name), value):
            self._twice(do, name, span)
        setattr(do, name, value)

    def _twice(self, do: Do, name: str, span: Span) -> None:
        what = name.replace("_", " ")
        message = f"`{do.base}` has another {what} already"
        self.diagnostics.error("repeated-limit", message, span, "leave one of the two out")

    def _window(self, do: Do, manner: Manner, span: Span) -> None:
        if manner.earliest is None and manner.latest is None:
            if manner.soft_window and do.window is None:
                message = "this does not say by when, or whether the task may be left out"
                hint = "write `preferably not later than 10 minutes after the start`, or `if there "
                hint += "is time`"
                self.diagnostics.error("ambiguous-manner", message, span, hint)
            elif manner.soft_window and do.window is not None:
                do.window = do.window.model_copy(update={"hard": False})
            return
        before = do.window if do.window is not None else TimeWindow()
        earliest, latest = manner.earliest, manner.latest
        if earliest is not None and before.earliest not in (0.0, earliest):
            self._twice(do, "earliest", span)
        if latest is not None and before.latest not in (None, latest):
            self._twice(do, "latest", span)
        do.window = TimeWindow(
            earliest=before.earliest if earliest is None else earliest,
            latest=before.latest if latest is None else latest,
            hard=before.hard and not manner.soft_window,
        )

    def _about(self, do: Do, object_id: str, span: Span) -> None:
        if do.action is Action.MEASURE:
            message = "a measurement is about its checkpoint"
            self.diagnostics.error("stray-clause", message, span, "leave `about object` out")
        do.object_id = object_id


def _joint_state(joints: Joints | None) -> JointState | None:
    if joints is None:
        return None
    return JointState(
        names=joints.names,
        positions=joints.positions,
        velocities=joints.velocities,
        efforts=joints.efforts,
    )
