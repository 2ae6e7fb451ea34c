"""Groups of a mission as nested ranges of its task list."""

from collections.abc import Mapping

from argo_compiler.base.memoization import cache_last_results_by_identity
from argo_compiler.base.records import dataclass
from argo_compiler.il.mission import Group, Mission


@dataclass(frozen=True, slots=True)
class GroupRange:
    """Group with the positions of its first and last task in the mission's list, inclusive."""

    group: Group
    first: int
    last: int
    index: int
    """position of the group in the mission's list of groups"""

    def contains(self, position: int) -> bool:
        return self.first <= position <= self.last


@cache_last_results_by_identity
def task_positions(mission: Mission) -> Mapping[str, int]:
    """Return the position of each task by its name; if several have one name, the first one's."""
    names = [task.name for task in mission.tasks]
    return dict(zip(reversed(names), range(len(names) - 1, -1, -1), strict=True))


def parent_name(name: str) -> str | None:
    """Return the name of the group around the group `name`: `Alpha` for `Alpha/Beta`.

    Returns None if there is none.
    """
    parent, slash, _ = name.rpartition("/")
    return parent if slash else None


def valid_ranges_parents_first(mission: Mission) -> tuple[GroupRange, ...]:
    """Return the ranges of the groups that have a valid one, parents before children.

    A range is valid if the tasks `start` and `end` exist and are in this order. The ranges are
    sorted by start, longest first; of two with the same tasks, the one whose name has fewer parts
    (`/`) comes first.
    """
    position = task_positions(mission)
    ranges = [
        GroupRange(group, position[group.start], position[group.end], index)
        for index, group in enumerate(mission.groups)
        if group.start in position and group.end in position
    ]
    ordered = (r for r in ranges if r.first <= r.last)
    return tuple(sorted(ordered, key=lambda r: (r.first, -r.last, r.group.name.count("/"))))


@dataclass(frozen=True)
class GroupNesting:
    """Nesting of a mission's groups. Tasks and ranges are identified by their positions."""

    ranges: tuple[GroupRange, ...]
    """parents before children"""
    parent: tuple[int | None, ...]
    """for each range, the smallest one around it; None if there is none"""
    innermost: tuple[int | None, ...]
    """for each task, the smallest range around it; None if there is none"""
    ending: tuple[tuple[int, ...], ...]
    """for each task, the ranges that end with it, innermost first"""

    @staticmethod
    def from_mission(mission: Mission) -> "GroupNesting":
        """Return the nesting of the groups of a mission, in which `check` must find no errors.

        Takes linear time.
        """
        return _nesting(mission)

    def innermost_common_range(self, range_index: int | None, task: int) -> int | None:
        """Return the smallest range that contains both the range `range_index` and the task.

        None stands for the mission, as an argument and as the result.
        """
        while range_index is not None and not self.ranges[range_index].contains(task):
            range_index = self.parent[range_index]
        return range_index


@cache_last_results_by_identity
def _nesting(mission: Mission) -> GroupNesting:
    ranges = valid_ranges_parents_first(mission)
    parent: list[int | None] = []
    innermost: list[int | None] = []
    ending: list[tuple[int, ...]] = []
    open_ranges: list[int] = []
    for i in range(len(mission.tasks)):
        while len(parent) < len(ranges) and ranges[len(parent)].first == i:
            parent.append(open_ranges[-1] if open_ranges else None)
            open_ranges.append(len(parent) - 1)
        innermost.append(open_ranges[-1] if open_ranges else None)
        ended = []
        while open_ranges and ranges[open_ranges[-1]].last == i:
            ended.append(open_ranges.pop())
        ending.append(tuple(ended))
    return GroupNesting(ranges, tuple(parent), tuple(innermost), tuple(ending))
