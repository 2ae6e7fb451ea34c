"""What drawings of a machine have in common: ids, nesting, and what stands on boxes and arrows."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from argo_compiler.hfsm import Composite, Hfsm, Leaf, StateTransition, TransitionKind
from argo_compiler.hfsm.conditions import all_words, awaited
from argo_compiler.hfsm.model import DONE
from argo_compiler.il import Afterwards, Reaction, Response, Stop, Task, WaitRule

_RESPONSES = {
    Response.REPORT: "report",
    Response.PAUSE: "pause",
    Response.RETURN: "return to the dock",
    Response.SAFE_AREA: "go to a safe area",
    Response.ABORT: "abort",
}

_AFTERWARDS = {
    Afterwards.RESUME: "go on",
    Afterwards.WAIT: "wait for a person",
    Afterwards.END: "end",
}


@dataclass(frozen=True)
class Arrow:
    """A transition as it is drawn."""

    source: str
    """id of a leaf, a choice, or a group that is left when its time is out"""
    target: str | None
    """id; None: the mission's end"""
    label: str
    leaves: Composite | None = None
    """the group that is the source, if one is"""


class Drawing:
    """A machine with ids by position: `t0` is the first leaf, `g1` the first group."""

    def __init__(self, hfsm: Hfsm) -> None:
        self.hfsm = hfsm
        self.composites = {c.id: c for c in hfsm.composites}
        self.leaves = {leaf.id: leaf for leaf in hfsm.leaves}
        self.ids = {leaf.id: f"t{i}" for i, leaf in enumerate(hfsm.leaves)}
        self.ids |= {c.id: f"g{i}" for i, c in enumerate(hfsm.composites)}

    def choice(self, id: str) -> str:
        """The id of what is decided when a round of the group ends: `r1` for `g1`."""
        return self.ids[id].replace("g", "r")

    def end(self, id: str) -> str | None:
        """The id of what a transition leads to; None for the mission's end."""
        return None if id == DONE else self.ids[id]

    def nested(self) -> Iterator[tuple[int, Leaf | Composite | None]]:
        """All leaves and groups in order, and how many groups they lie in; None closes a group.

        Not recursive, as groups may be nested to any depth.
        """
        depth = 0
        pending: list[str | None] = list(reversed(self.hfsm.mission.children))
        while pending:
            id = pending.pop()
            if id is None:
                depth -= 1
                yield depth, None
            elif leaf := self.leaves.get(id):
                yield depth, leaf
            elif id != DONE:
                group = self.composites[id]
                yield depth, group
                depth += 1
                pending += [None, *reversed(group.children)]

    def arrows(self) -> Iterator[Arrow]:
        """All transitions: those of the leaves, then those of the groups."""
        for leaf in self.hfsm.leaves:
            ways = (*leaf.transitions, leaf.failure, leaf.missed)
            yield from (self._arrow(self.ids[leaf.id], way) for way in ways if way)
        for group in self.hfsm.composites[1:]:
            for way in group.transitions:
                yield self._arrow(self.choice(group.id), way, group)
            if group.timeout:
                arrow = self._arrow(self.ids[group.id], group.timeout, group)
                yield replace(arrow, leaves=group)

    def _arrow(self, source: str, way: StateTransition, group: Composite | None = None) -> Arrow:
        if way.completes is not None:
            target: str | None = self.choice(way.completes)
        else:
            target = self.end(way.target or DONE)
        return Arrow(source, target, transition_words(way, group))

    def first_leaf(self, group: Composite) -> str:
        """The id of a leaf that lies in the group."""
        id = group.children[0]
        while id not in self.leaves:
            id = self.composites[id].children[0]
        return id


def transition_words(transition: StateTransition, group: Composite | None = None) -> str:
    """Why it is taken, as text; empty where nothing has to be said."""
    if transition.kind is TransitionKind.CONDITIONAL:
        return all_words(transition.conditions)
    if transition.kind is TransitionKind.FAILURE:
        return "failed, abort" if transition.target == DONE else "failed"
    if transition.kind is TransitionKind.MISSED:
        return "window missed"
    if group is None or group.repeat is None or transition.kind is TransitionKind.DEFAULT:
        return ""
    if transition.kind is TransitionKind.TIMEOUT:
        return f"time out after {group.repeat.duration:g} s"
    limits = []
    if group.repeat.count:
        limits.append(f"up to {group.repeat.count} rounds")
    if group.repeat.duration:
        limits.append(f"for {group.repeat.duration:g} s")
        limits += ["rounds completed"] if group.repeat.stop is Stop.SOFT else []
        limits += ["interruptions counted"] if group.repeat.count_interruptions else []
    if group.repeat.every:
        limits.append(f"every {group.repeat.every:g} s")
    if group.repeat.until:
        limits.append(f"until {all_words(group.repeat.until)}")
    return ", ".join(["repeat", *limits])


def task_words(task: Task) -> str:
    """The task's name, and in brackets how long, when and how fast it is done."""
    parts = [] if task.wait is None else [_wait_words(task.wait)]
    if task.velocity is not None:
        parts.append(f"at {task.velocity:g} m/s")
    if task.time_limit is not None:
        parts.append(f"within {task.time_limit:g} s")
    if task.reading_limit is not None:
        parts.append(f"read within {task.reading_limit:g} s")
    if task.retries:
        parts.append(f"up to {task.retries} retries")
    if task.window is not None:
        if task.window.earliest:
            parts.append(f"not before {task.window.earliest:g} s")
        if task.window.latest is not None:
            kind = "by" if task.window.hard else "best by"
            parts.append(f"{kind} {task.window.latest:g} s")
    if task.optional:
        parts.append("optional")
    if task.priority != 1:
        parts.append(f"priority {task.priority}")
    return f"{task.name} ({', '.join(parts)})" if parts else task.name


def _wait_words(wait: WaitRule) -> str:
    if wait.duration is not None:
        return f"wait {wait.duration:g} s" if wait.duration else "where ways meet"
    limit = "" if wait.limit is None else f", at most {wait.limit:g} s"
    return f"wait until {awaited(wait)}{limit}"


def reaction_words(reaction: Reaction) -> str:
    """The reaction in a few words, such as `gas leak: pause, until all clear`."""
    parts = [_RESPONSES[reaction.response]]
    if reaction.until is not None:
        parts.append(f"until {reaction.until.replace('_', ' ')}")
    if reaction.response.drives:
        parts.append(f"then {_AFTERWARDS[reaction.afterwards]}")
    if reaction.hold_limit is not None:
        parts.append(f"after {reaction.hold_limit:g} s at most {_AFTERWARDS[reaction.on_limit]}")
    if reaction.priority is not None:
        parts.append(f"priority {reaction.priority}")
    event = reaction.event.replace("_", " ")
    if reaction.battery_below is not None:
        event += f" (below {100 * reaction.battery_below:g} %)"
    return f"{event}: {', '.join(parts)}"
