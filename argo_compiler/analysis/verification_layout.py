"""Points and groups of a mission, for the checkers of witnesses."""

from argo_compiler.il import Action, Mission, Stop

ProgramPoint = tuple[str, int]
"""point of a run: `task`, `round` or `cut` with an index into the mission's list of tasks or
groups; or END"""
END: ProgramPoint = ("end", 0)


class MissionLayout:
    """Nesting of a mission's tasks and groups (G1), by their indices in the mission's lists."""

    def __init__(self, mission: Mission) -> None:
        self.position = {task.name: i for i, task in enumerate(mission.tasks)}
        self.group_position = {group.name: g for g, group in enumerate(mission.groups)}
        groups = mission.groups
        first = [self.position[group.start] for group in groups]
        self.last = [self.position[group.end] for group in groups]
        self.parent = [self.group_position.get(g.name.rpartition("/")[0]) for g in groups]
        self.innermost: list[int | None] = [None] * len(mission.tasks)
        self.ending: list[int | None] = [None] * len(mission.tasks)
        """for each task, the innermost group that ends with it"""
        self.hard = [g.max_repeat_duration > 0 and g.stop is Stop.HARD for g in groups]
        self.timed = [False] * len(groups)
        self.ending_around: list[int | None] = [None] * len(groups)
        """for each group, the enclosing group if that ends with the same task"""
        depth = [group.name.count("/") for group in groups]
        opened: dict[int, list[int]] = {}
        for g in sorted(range(len(groups)), key=lambda g: depth[g]):
            around = self.parent[g]
            self.timed[g] = self.hard[g] or (around is not None and self.timed[around])
            if around is not None and self.last[around] == self.last[g]:
                self.ending_around[g] = around
            self.ending[self.last[g]] = g
            opened.setdefault(first[g], []).append(g)
        inside: list[int] = []
        for i in range(len(mission.tasks)):
            inside += opened.get(i, ())
            if inside:
                self.innermost[i] = inside[-1]
            while inside and self.last[inside[-1]] == i:
                inside.pop()
        self.begin = self._find_begin(mission)

    def task_point(self, name: str) -> ProgramPoint:
        return "task", self.position[name]

    def _find_begin(self, mission: Mission) -> ProgramPoint:
        start = next((t for t in mission.tasks if t.action is Action.START), None)
        if start is not None:
            for transition in start.transitions:
                if not transition.conditions:
                    return self.task_point(transition.target)
        for i, task in enumerate(mission.tasks):
            if task.action is not Action.START:
                return "task", i
        return END
