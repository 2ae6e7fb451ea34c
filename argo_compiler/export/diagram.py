"""Parts that all diagrams of a machine share: ids, nesting, and the labels of boxes and arrows."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from argo_compiler.hfsm import Composite, Hfsm, Leaf, StateTransition, TransitionKind
from argo_compiler.hfsm.conditions import awaited_event_text, conjunction_text, wait_end_text
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
    Afterwards.RESUME: "resume",
    Afterwards.WAIT: "wait for a person",
    Afterwards.END: "end",
}


@dataclass(frozen=True)
class Arrow:
    """Transition as an arrow of a diagram."""

    source: str
    """id of a leaf, a choice, or a group (for its time-out)"""
    target: str | None
    """id of a leaf, a choice or a group; None for the mission's end"""
    label: str
    source_group: Composite | None = None
    """group at which the arrow starts; None if the source is a leaf or a choice"""


class Diagram:
    """Machine whose states have ids by position: `t0` the first leaf, `g1` the first group."""

    def __init__(self, hfsm: Hfsm) -> None:
        self.hfsm = hfsm
        self.composites = {c.id: c for c in hfsm.composites}
        self.leaves = {leaf.id: leaf for leaf in hfsm.leaves}
        self.ids = {leaf.id: f"t{i}" for i, leaf in enumerate(hfsm.leaves)}
        self.ids |= {c.id: f"g{i}" for i, c in enumerate(hfsm.composites)}

    def round_end_choice_id(self, group_id: str) -> str:
        """Return the diagram's id of the choice at the end of a group's round: `r1` for `g1`.

        `group_id` is the machine's id of the group.
        """
        return self.ids[group_id].replace("g", "r")

    def id_unless_mission_end(self, id: str) -> str | None:
        """Return the diagram's id of the machine's state `id`, or None for the mission's end."""
        return None if id == DONE else self.ids[id]

    def elements_and_ends_with_depths(self) -> Iterator[tuple[int, Leaf | Composite | None]]:
        """Yield all leaves and groups in order, each with the number of groups that contain it.

        None instead of a leaf or group marks the end of a group, with the same number as the group.
        This is not recursive, as groups may be nested to any depth.
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

    def transition_arrows(self) -> Iterator[Arrow]:
        """Yield all transitions as arrows: first those of the leaves, then those of the groups."""
        for leaf in self.hfsm.leaves:
            transitions = (*leaf.transitions, leaf.failure, leaf.missed)
            yield from (self._arrow(self.ids[leaf.id], t) for t in transitions if t)
        for group in self.hfsm.composites[1:]:
            for transition in group.transitions:
                yield self._arrow(self.round_end_choice_id(group.id), transition, group)
            if group.timeout:
                arrow = self._arrow(self.ids[group.id], group.timeout, group)
                yield replace(arrow, source_group=group)

    def _arrow(
        self, source: str, transition: StateTransition, group: Composite | None = None
    ) -> Arrow:
        if transition.completes is not None:
            target: str | None = self.round_end_choice_id(transition.completes)
        else:
            target = self.id_unless_mission_end(transition.target or DONE)
        return Arrow(source, target, transition_label(transition, group))

    def first_leaf_id(self, group: Composite) -> str:
        """Return the machine's id of the group's first leaf, which may be in a nested group."""
        id = group.children[0]
        while id not in self.leaves:
            id = self.composites[id].children[0]
        return id


def transition_label(transition: StateTransition, group: Composite | None = None) -> str:
    """Return the label of a transition's arrow: why it is taken; empty for an unconditional one.

    `group` is the group that the transition belongs to; None if it belongs to a task.
    """
    if transition.kind is TransitionKind.CONDITIONAL:
        return conjunction_text(transition.conditions)
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
        limits.append(f"until {conjunction_text(group.repeat.until)}")
    return ", ".join(["repeat", *limits])


def task_label_with_limits(task: Task) -> str:
    """Return the task's name, followed in brackets by its durations, times, speed and limits."""
    parts = [] if task.wait is None else [_wait_label(task.wait)]
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


def _wait_label(wait: WaitRule) -> str:
    if wait.duration is not None:
        return f"wait {wait.duration:g} s" if wait.duration else "junction"
    limit = "" if wait.limit is None else f", at most {wait.limit:g} s"
    return f"wait until {wait_end_text(wait)}{limit}"


def reaction_label(reaction: Reaction) -> str:
    """Return a short text for the reaction, such as `gas leak: pause, until all clear`."""
    parts = [_RESPONSES[reaction.response]]
    if reaction.until is not None:
        parts.append(f"until {awaited_event_text(reaction.until, reaction)}")
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
