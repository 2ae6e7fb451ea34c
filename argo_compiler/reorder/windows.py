"""Time windows of tasks, in the form that the route problem needs."""

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.base.quantity_text import limit_text
from argo_compiler.il import Action, TimeWindow
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.reorder.visits import Visits


def require_computable_times(visits: Visits) -> None:
    """Raise Invalid if the time of some task or the effect of its window can't be computed."""
    flow = visits.chain.flow
    for group in flow.groups:
        if group.every:
            raise Invalid(
                Message(
                    "group '{group}' starts its rounds at set times: Argo can't compute orders "
                    "of missions with planned rounds yet",
                    group=group.name,
                )
            )
    for leaf in visits.chain.conditions_checked_after:
        task = flow.leaves[leaf].leaf.task
        if task.wait is not None and task.wait.duration is None and task.wait.limit is None:
            raise Invalid(
                Message(
                    "how long '{task}' waits can't be computed: give it a limit", task=task.name
                )
            )
    inside = {leaf for _, members in visits.group_units for k in members
              for leaf in visits.task_units[k].leaves}  # fmt: skip
    entries = {unit.entry for unit in visits.task_units} - inside
    for leaf in visits.chain.conditions_checked_after:
        window = _binding_window(flow.leaves[leaf].leaf.task.window)
        is_wait = flow.leaves[leaf].leaf.task.action is Action.WAIT
        if window is None or (leaf in entries and not is_wait):
            continue
        name = flow.leaves[leaf].name
        if is_wait:
            why = Message("it is a wait")
        elif leaf in inside:
            why = Message("it is in a group, and a window does not state in which round")
        elif leaf != visits.chain.end:
            why = Message("it is not done in all cases, or right after another task")
        elif window.earliest:
            why = Message("it ends the mission, and would have to wait at its pose")
        else:
            continue
        raise Invalid(
            Message(
                "the time window of '{name}' can't be kept by an order: {why}", name=name, why=why
            )
        )


class Windows:
    """Limits that time windows set for an order: `earliest`, and the `latest` of hard windows."""

    def __init__(self, visits: Visits, matrix: TravelMatrix) -> None:
        self._visits, self._matrix = visits, matrix

    def start_limits(self, visit: int) -> tuple[int, int | None]:
        """Return the earliest and latest start of a visit's action in units of time.

        With the latest start, the action ends at the end of its hard window; it is None if there is
        no limit.
        """
        entry = self._visits.task_units[visit].entry
        window = _binding_window(self._visits.leaf_task(entry).window)
        if window is None:
            return 0, None
        latest = None
        if window.hard and window.latest is not None:
            latest = max(
                -1, self._matrix.units_rounded_down(window.latest) - int(self._matrix.work[entry])
            )
        return self._matrix.units_rounded_up(window.earliest), latest

    def latest_end_text(self, visit: int) -> str | None:
        """Return the visit's window in words, or None if it sets no latest end."""
        window = _binding_window(
            self._visits.leaf_task(self._visits.task_units[visit].entry).window
        )
        if window is None or not window.hard or window.latest is None:
            return None
        start = (
            Message("begun from {limit} on and ", limit=limit_text(window.earliest))
            if window.earliest
            else ""
        )
        return Message(
            "{name} {start}done by {limit}",
            name=self._visits.names[visit],
            start=start,
            limit=limit_text(window.latest),
        )

    def end_limit_seconds(self) -> tuple[float, str] | None:
        """Return the latest end of the mission's last task in s, and its description.

        It counts from the mission's start. Returns None if no window limits the end.
        """
        end = self._visits.chain.end
        window = None if end is None else _binding_window(self._visits.leaf_task(end).window)
        if end is None or window is None or window.latest is None:
            return None
        return window.latest, Message("time window of '{task}'", task=self._visits.chain.name(end))


def _binding_window(window: TimeWindow | None) -> TimeWindow | None:
    """Return the window if it has an earliest start or a hard latest end, else None."""
    if window is None or not (window.earliest or (window.hard and window.latest is not None)):
        return None
    return window
