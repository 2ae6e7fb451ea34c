"""Drawing of the state machine: states from top to bottom, transitions as arrows.

Every state is a row. A transition without a label to the next state below is a short arrow. Any
other one leaves its row on the right, in a slot of its own that holds its label, and runs down or
up in a lane where it meets no other. So no label can overlap another one or a line of another one.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from argo_compiler.hfsm import Composite, Hfsm, StateTransition, TransitionKind
from argo_compiler.hfsm.conditions import conjunction_text
from argo_compiler.hfsm.model import DONE, MISSION
from argo_compiler.il import Stop
from argo_env.report.svg import Node, drawing, node, number, shorten

MAX_STATES = 45
"""largest number of leaves and composites of a machine that is drawn"""

NODE_WIDTH = 290.0  # px
SLOT = 19.0  # px, height of one transition's label
GAP = 16.0  # px between rows
PAD = 14.0  # px between the borders of nested boxes
LANE = 11.0  # px between parallel lines of transitions
CHARACTER = 6.3  # px, width of a character of a label
MAX_LABEL = 46  # characters

_DECISION = "decide "
"""prefix of a composite's id: key of the row from which the transitions of its end leave"""

_INITIAL = "initial"
_AFTER_FAILURES = {TransitionKind.FAILURE: "failed", TransitionKind.MISSED: "time window missed"}


@dataclass
class _Row:
    """Row of the drawing. The layout adds the slots of transitions, then sets `y`."""

    key: str
    kind: str
    text: str
    depth: int
    slots: list[int] = field(default_factory=list)
    """numbers of the arrows that leave or enter on the right, from above"""
    y: float = 0.0

    @property
    def height(self) -> float:
        least = {"leaf": 34.0, "decision": 24.0, "head": 26.0}.get(self.kind, 22.0)
        return max(least, SLOT * len(self.slots) + 6)

    def slot_y(self, arrow: int) -> float:
        """Return the y (px) at which the arrow with this number leaves or enters the row."""
        offset = (self.height - SLOT * len(self.slots)) / 2
        return self.y + offset + SLOT * (self.slots.index(arrow) + 0.8)


@dataclass(frozen=True)
class _Arrow:
    """Arrow of one transition between two rows, by their keys."""

    source: str
    target: str
    kind: str
    label: str


def is_drawable(hfsm: Hfsm) -> bool:
    """Return True if the machine is small enough to be readable as a drawing."""
    return len(hfsm.leaves) + len(hfsm.composites) <= MAX_STATES


def draw_machine(hfsm: Hfsm) -> Node:
    """Draw the state machine as SVG.

    The drawing has one element of the CSS class `state` for each leaf and composite, and one of the
    CSS class `way` for each transition and for the start.
    """
    rows = _rows(hfsm)
    index = {row.key: i for i, row in enumerate(rows)}
    arrows = list(_arrows(hfsm))
    straight = {
        i
        for i, arrow in enumerate(arrows)
        if not arrow.label and _are_adjacent(rows, index[arrow.source], index[arrow.target])
    }
    for i, arrow in enumerate(arrows):
        if i not in straight:
            rows[index[arrow.source]].slots.append(i)
            rows[index[arrow.target]].slots.append(i)
    y = 10.0
    for row in rows:
        row.y = y
        y += row.height + (GAP if row.kind != "head" else 8.0)
    depth = max(row.depth for row in rows)
    left = 10.0 + depth * PAD
    labels = left + NODE_WIDTH + depth * PAD + 12
    longest = max((len(arrow.label) for arrow in arrows), default=0)
    lanes = labels + longest * CHARACTER + 14
    spans = {
        i: (rows[index[a.source]].slot_y(i), rows[index[a.target]].slot_y(i))
        for i, a in enumerate(arrows)
        if i not in straight
    }
    lane = _lanes(spans)
    parts = _boxes(hfsm, rows, index, left)
    for i, arrow in enumerate(arrows):
        source, target = rows[index[arrow.source]], rows[index[arrow.target]]
        if i in straight:
            parts.append(_straight_arrow(arrow, source, target, left))
        else:
            parts.append(
                _bent_arrow(arrow, (source, target), i, left, labels, lanes + lane[i] * LANE)
            )
    # States are drawn after the arrows, so a straight arrow passes below the title of a group.
    parts += [_state(row, left, depth) for row in rows]
    width = lanes + (max(lane.values(), default=0) + 1) * LANE + 6
    return drawing(width, y, "State machine of the mission", *parts, class_="drawing machine")


def _rows(hfsm: Hfsm) -> list[_Row]:
    composites = {c.id: c for c in hfsm.composites}
    names = {leaf.id: leaf.task.name for leaf in hfsm.leaves}
    rows = [_Row(_INITIAL, "initial", "", 0)]
    # Not recursive, as groups may be nested to any depth.
    pending: list[tuple[str, int]] = [(MISSION, 0)]
    while pending:
        id, depth = pending.pop()
        if id in names:
            rows.append(_Row(id, "leaf", names[id], depth))
        elif id == DONE:
            rows.append(_Row(id, "final", "end", depth))
        elif id.startswith(_DECISION):
            rows.append(_Row(id, "decision", "end of the round", depth))
        else:
            composite = composites[id]
            inner = composite.name if id == MISSION else composite.name.rpartition("/")[2]
            rows.append(_Row(id, "head", inner or "mission", depth + 1))
            if composite.transitions:
                pending.append((_DECISION + id, depth + 1))
            pending += [(child, depth + 1) for child in reversed(composite.children)]
    return rows


def _arrows(hfsm: Hfsm) -> Iterator[_Arrow]:
    yield _Arrow(_INITIAL, hfsm.mission.initial, "begin", "")
    for leaf in hfsm.leaves:
        for transition in leaf.transitions:
            yield _arrow(leaf.id, transition, None)
        for transition in filter(None, (leaf.failure, leaf.missed)):
            yield _arrow(leaf.id, transition, None)
    for group in hfsm.composites:
        for transition in group.transitions:
            yield _arrow(_DECISION + group.id, transition, group)
        if group.timeout:
            yield _arrow(group.id, group.timeout, group)


def _arrow(source: str, transition: StateTransition, group: Composite | None) -> _Arrow:
    completed = transition.completes
    target = transition.target or DONE if completed is None else _DECISION + completed
    return _Arrow(source, target, transition.kind, shorten(_label(transition, group), MAX_LABEL))


def _label(transition: StateTransition, group: Composite | None) -> str:
    if transition.kind is TransitionKind.CONDITIONAL:
        return conjunction_text(transition.conditions)
    if transition.kind in _AFTER_FAILURES:
        return _AFTER_FAILURES[transition.kind]
    if group is None or group.repeat is None:
        return ""
    if transition.kind is TransitionKind.TIMEOUT:
        return f"time out after {group.repeat.duration:g} s"
    if transition.kind is TransitionKind.DEFAULT:
        return ""
    limits = ["repeat"]
    if group.repeat.until:
        limits = [f"repeat until {conjunction_text(group.repeat.until)}"]
    limits += [f"up to {group.repeat.count} rounds"] if group.repeat.count else []
    if group.repeat.duration:
        whole = ", whole rounds" if group.repeat.stop is Stop.SOFT else ""
        limits.append(f"for {group.repeat.duration:g} s{whole}")
    limits += [f"every {group.repeat.every:g} s"] if group.repeat.every else []
    return ", ".join(limits)


def _are_adjacent(rows: list[_Row], source: int, target: int) -> bool:
    """Return True if `target` is below `source`, and only heads of groups are between them."""
    return source < target and all(row.kind == "head" for row in rows[source + 1 : target])


def _lanes(spans: dict[int, tuple[float, float]]) -> dict[int, int]:
    """Return a lane for each transition, by its number; those in the same lane do not meet.

    `spans` gives the y (px) of both ends. Short transitions get the inner lanes, which have
    the lowest numbers.
    """
    lanes: list[list[tuple[float, float]]] = []
    result = {}
    for i, (a, b) in sorted(spans.items(), key=lambda item: (abs(item[1][1] - item[1][0]), item)):
        low, high = min(a, b), max(a, b)
        free = (
            k for k, lane in enumerate(lanes) if all(high < c - 2 or low > d + 2 for c, d in lane)
        )
        index = next(free, len(lanes))
        if index == len(lanes):
            lanes.append([])
        lanes[index].append((low, high))
        result[i] = index
    return result


def _boxes(hfsm: Hfsm, rows: list[_Row], index: dict[str, int], left: float) -> list[Node]:
    boxes = []
    for composite in hfsm.composites:
        first = index[composite.id]
        depth = rows[first].depth
        last = first
        while last + 1 < len(rows) and _is_inside(rows[last + 1], depth):
            last += 1
        deeper = max(row.depth for row in rows[first : last + 1]) - depth
        top, bottom = rows[first].y - 2, rows[last].y + rows[last].height + 4
        bottom += 3.0 * deeper
        most = max(row.depth for row in rows)
        margin = (most - depth + 1) * PAD
        x = left - margin
        boxes.append(
            node(
                "g",
                node(
                    "rect",
                    x=x,
                    y=top,
                    width=NODE_WIDTH + 2 * margin,
                    height=bottom - top,
                    rx=8.0,
                ),
                class_="state composite",
            )
        )
    return boxes


def _is_inside(row: _Row, depth: int) -> bool:
    """Return True if `row`, which follows rows of a composite, belongs to the composite as well.

    `depth` is that of the composite's head and of its leaves, 1 for the machine itself; another
    head with this depth begins the next composite.
    """
    return row.depth > depth or (row.depth == depth and row.kind != "head")


def _state(row: _Row, left: float, depth: int) -> Node:
    middle = row.y + row.height / 2
    text = node("title", text=row.text)
    if row.kind in {"initial", "final"}:
        x = left + NODE_WIDTH / 2
        dots = [node("circle", cx=x, cy=middle, r=6.0, class_="dot")]
        if row.kind == "final":
            dots.append(node("circle", cx=x, cy=middle, r=9.5, class_="ring"))
        return node("g", *dots, class_=row.kind)
    if row.kind == "head":
        name = shorten(row.text, 38)
        return node(
            "g",
            text,
            node("text", x=left - (depth - row.depth) * PAD, y=row.y + 17, text=name),
            class_="head",
        )
    box = node(
        "rect",
        x=left,
        y=row.y,
        width=NODE_WIDTH,
        height=row.height,
        rx=9.0 if row.kind == "leaf" else 0.0,
    )
    label = node("text", x=left + 14, y=middle + 4, text=shorten(row.text, 40))
    return node("g", text, box, label, class_="state leaf" if row.kind == "leaf" else "decision")


def _straight_arrow(arrow: _Arrow, source: _Row, target: _Row, left: float) -> Node:
    x = left + NODE_WIDTH * (0.5 if "head" not in (source.kind, target.kind) else 0.9)
    if source.kind == "initial":
        x = left + NODE_WIDTH / 2
    start = source.y + source.height / 2 if source.kind == "initial" else source.y + source.height
    end = target.y + (target.height / 2 - 10 if target.kind == "final" else 0)
    tip = f"M{number(x)},{number(end)}l-4,-8h8z"
    return node(
        "g",
        node("path", d=f"M{number(x)},{number(start)}V{number(end - 6)}", class_="line"),
        node("path", d=tip, class_="tip"),
        class_=f"way {arrow.kind}",
    )


def _bent_arrow(
    arrow: _Arrow, ends: tuple[_Row, _Row], index: int, left: float, labels: float, lane: float
) -> Node:
    start, end = (row.slot_y(index) for row in ends)
    if ends[0] is ends[1]:
        # A transition to its own row is listed twice there, so its ends lie in neighbouring slots.
        end = start + SLOT
    edges = [
        left + NODE_WIDTH / 2 + 10 if r.kind in {"initial", "final"} else left + NODE_WIDTH
        for r in ends
    ]
    line = (
        f"M{number(edges[0])},{number(start)}H{number(lane)}V{number(end)}H{number(edges[1] + 7)}"
    )
    tip = f"M{number(edges[1])},{number(end)}l8,-4v8z"
    parts = [
        node("path", d=line, class_="line"),
        node("path", d=tip, class_="tip"),
    ]
    if arrow.label:
        parts.append(node("text", x=labels, y=start - 4, text=arrow.label))
    return node("g", *parts, class_=f"way {arrow.kind}")
