"""Subjects of diagnostics: names for the parts of a mission, and their places in its lists."""

from collections.abc import Iterable
from functools import cached_property

from argo_compiler.diagnostics.subject import NamedItem, split_subject, subject_of
from argo_compiler.il.mission import Mission


class Subjects:
    """Subjects for the tasks, groups and reactions of a mission; a reaction's name is its event.

    If several have one name, the first is identified by it, the others by their positions. Built in
    linear time.
    """

    def __init__(self, mission: Mission) -> None:
        self.mission = mission

    def task_subject(self, position: int, rest: str = "") -> str:
        """Return the subject of the task at a position, followed by `rest`, such as `.pose`."""
        return _named("tasks", position, self._tasks, rest)

    def group_subject(self, position: int, rest: str = "") -> str:
        """Return the subject of the group at a position, followed by `rest`, such as `.pose`."""
        return _named("groups", position, self._groups, rest)

    def reaction_subject(self, position: int, rest: str = "") -> str:
        """Return the subject of the reaction at a position, followed by `rest`, such as `.pose`."""
        return _named("reactions", position, self._reactions, rest)

    def subject_path(self, text: str) -> tuple[str | int, ...]:
        """Return the path that a subject stands for: fields, and positions in the mission's lists.

        If the subject names something that the mission does not have, the path ends with the list
        in which that was looked for.
        """
        steps: list[str | int] = []
        for step in split_subject(text):
            if not isinstance(step, NamedItem):
                steps.append(step)
                continue
            lists = {"tasks": self._tasks, "groups": self._groups, "reactions": self._reactions}
            _, first = lists.get(str(steps[-1]), ([], {})) if steps else ([], {})
            if step.name not in first:
                break
            steps.append(first[step.name])
        return tuple(steps)

    @cached_property
    def _tasks(self) -> "_Names":
        return _names(task.name for task in self.mission.tasks)

    @cached_property
    def _groups(self) -> "_Names":
        return _names(group.name for group in self.mission.groups)

    @cached_property
    def _reactions(self) -> "_Names":
        return _names(reaction.event.value for reaction in self.mission.reactions)


_Names = tuple[list[str], dict[str, int]]
"""names by position, and the first position of each name"""


def _names(names: Iterable[str]) -> _Names:
    ordered = list(names)
    # Reversed, so that the first of several with one name is inserted last and counts.
    return ordered, dict(zip(reversed(ordered), range(len(ordered) - 1, -1, -1), strict=True))


def _named(field: str, position: int, names: _Names, rest: str) -> str:
    ordered, first = names
    name = ordered[position]
    return (
        subject_of(field, name, rest) if first[name] == position else f"{field}[{position}]{rest}"
    )
