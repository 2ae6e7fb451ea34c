"""A machine as a Mermaid state diagram, for documents and pages that render Mermaid."""

import re

from argo_compiler.hfsm.conditions import words
from argo_compiler.hfsm.model import (
    DONE,
    MISSION,
    Composite,
    Hfsm,
    Leaf,
    Transition,
    TransitionKind,
)
from argo_compiler.il import Stop

_UNSAFE = re.compile(r"(?<=direction)\s|[^\w ,().-]", re.IGNORECASE)
"""What may mean something to Mermaid, which also takes `direction LR` inside of names."""


def to_mermaid(hfsm: Hfsm) -> str:
    """The machine as text of a `stateDiagram-v2`.

    Ids are made from positions (`t0` the first leaf, `g1` the first group), labels are the names.
    Beside each group stands a choice, `r1` for `g1`: what is decided there when a round ends.
    """
    return "\n".join(_Diagram(hfsm).lines()) + "\n"


class _Diagram:
    def __init__(self, hfsm: Hfsm) -> None:
        self.hfsm = hfsm
        self.composites = {c.id: c for c in hfsm.composites}
        self.leaves = {leaf.id: leaf for leaf in hfsm.leaves}
        self.ids: dict[str, str] = {DONE: "[*]"}
        self.ids |= {leaf.id: f"t{i}" for i, leaf in enumerate(hfsm.leaves)}
        self.ids |= {c.id: f"g{i}" for i, c in enumerate(hfsm.composites)}

    def lines(self) -> list[str]:
        lines = ["stateDiagram-v2", *self._states(), f"    [*] --> {self._initial()}"]
        # All states come first and all transitions last, outside of every group: that is how
        # Mermaid accepts transitions between states of different groups.
        for leaf in self.hfsm.leaves:
            lines += (self._arrow(self.ids[leaf.id], t) for t in leaf.transitions)
        for group in self.hfsm.composites[1:]:
            choice = self._choice(group.id)
            lines += (self._arrow(choice, t, group) for t in group.transitions)
            if group.timeout:
                lines.append(self._arrow(self.ids[group.id], group.timeout, group))
        return lines

    def _initial(self) -> str:
        return self.ids[self.hfsm.mission.initial]

    def _states(self) -> list[str]:
        lines: list[str] = []
        # Not recursive, as groups may be nested to any depth. A string closes a group.
        pending: list[str | Leaf | Composite] = []
        self._push_children(pending, self.composites[MISSION])
        depth = 1
        while pending:
            item = pending.pop()
            indent = "    " * depth
            if isinstance(item, str):
                depth -= 1
                lines.append("    " * depth + item)
            elif isinstance(item, Leaf):
                lines.append(f'{indent}state "{_escape(item.task.name)}" as {self.ids[item.id]}')
            else:
                lines.append(f"{indent}state {self._choice(item.id)} <<choice>>")
                lines.append(f'{indent}state "{_escape(item.name)}" as {self.ids[item.id]} {{')
                depth += 1
                pending.append("}")
                self._push_children(pending, item)
        return lines

    def _push_children(self, pending: list[str | Leaf | Composite], composite: Composite) -> None:
        for id in reversed(composite.children):
            if id != DONE:
                pending.append(self.leaves.get(id) or self.composites[id])

    def _choice(self, id: str) -> str:
        return self.ids[id].replace("g", "r")

    def _arrow(self, source: str, transition: Transition, group: Composite | None = None) -> str:
        if transition.completes is not None:
            target = self._choice(transition.completes)
        else:
            target = self.ids[transition.target or DONE]
        label = _label(transition, group)
        return f"    {source} --> {target}" + (f" : {_escape(label)}" if label else "")


def _label(transition: Transition, group: Composite | None) -> str:
    if transition.kind is TransitionKind.CONDITIONAL:
        return " and ".join(words(condition) for condition in transition.conditions)
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
    return ", ".join(["repeat", *limits])


def _escape(text: str) -> str:
    """The text with Mermaid's entity codes for everything that is not plain."""
    return _UNSAFE.sub(lambda match: f"#{ord(match[0])};", text)
