"""Time windows of tasks, as the route problem has them."""

from argo_compiler.analysis.quantities import time_words
from argo_compiler.base.errors import Invalid
from argo_compiler.il import Action, TimeWindow
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.reorder.visits import Visits


def require_reckonable(visits: Visits) -> None:
    """Raises Invalid where it can't be reckoned when something is done."""
    flow = visits.spine.flow
    for group in flow.groups:
        if group.every:
            raise Invalid(
                f"group '{group.name}' begins its rounds at set times: Argo can't reckon orders of "
                "missions with planned rounds yet"
            )
    for leaf in visits.spine.asked:
        task = flow.leaves[leaf].leaf.task
        if task.wait is not None and task.wait.duration is None and task.wait.limit is None:
            raise Invalid(f"how long '{task.name}' waits can't be reckoned: give it a limit")
    inside = {leaf for _, members in visits.circuits for k in members
              for leaf in visits.stops[k].leaves}  # fmt: skip
    entries = {stop.entry for stop in visits.stops} - inside
    for leaf in visits.spine.asked:
        window = _binding(flow.leaves[leaf].leaf.task.window)
        waits = flow.leaves[leaf].leaf.task.action is Action.WAIT
        if window is None or (leaf in entries and not waits):
            continue
        name = flow.leaves[leaf].name
        if waits:
            why = "it is a wait"
        elif leaf in inside:
            why = "it lies in a group, and a window does not say in which round"
        elif leaf != visits.spine.end:
            why = "it is not done in all cases, or right after another task"
        elif window.earliest:
            why = "it ends the mission, and would have to wait at the place"
        else:
            continue
        raise Invalid(f"the time window of '{name}' can't be kept by an order: {why}")


class Windows:
    """What of the windows binds an order: `earliest`, and `latest` of hard ones."""

    def __init__(self, visits: Visits, ways: TravelMatrix) -> None:
        self._visits, self._ways = visits, ways

    def of_visit(self, visit: int) -> tuple[int, int | None]:
        """When it may begin, and when it must have begun (units): in time to end by `latest`."""
        entry = self._visits.stops[visit].entry
        window = _binding(self._visits.task(entry).window)
        if window is None:
            return 0, None
        latest = None
        if window.hard and window.latest is not None:
            latest = max(-1, self._ways.down(window.latest) - int(self._ways.work[entry]))
        return self._ways.up(window.earliest), latest

    def words(self, visit: int) -> str | None:
        """What the mission says of it, if it has to have ended by a time."""
        window = _binding(self._visits.task(self._visits.stops[visit].entry).window)
        if window is None or not window.hard or window.latest is None:
            return None
        begin = f"begun from {time_words(window.earliest)} on and " if window.earliest else ""
        return f"{self._visits.names[visit]} {begin}done by {time_words(window.latest)}"

    def of_the_end(self) -> tuple[float, str] | None:
        """By when the task that ends the mission has to have ended (s), and how that is said."""
        end = self._visits.spine.end
        window = None if end is None else _binding(self._visits.task(end).window)
        if end is None or window is None or window.latest is None:
            return None
        return window.latest, f"time window of '{self._visits.spine.name(end)}'"


def _binding(window: TimeWindow | None) -> TimeWindow | None:
    """The window, if it binds an order."""
    if window is None or not (window.earliest or (window.hard and window.latest is not None)):
        return None
    return window
