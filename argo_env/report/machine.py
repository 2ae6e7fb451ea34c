"""The state machine as a drawing: states from top to bottom, ways beside them.

Every state is a row. The way to the state right below is a short arrow; any other one leaves its
row on the right, in a slot of its own that holds its label, and runs down or up in a lane of its
own. So no label can meet another one or a line that does not belong to it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from argo_compiler.hfsm import Composite, Hfsm, StateTransition, TransitionKind
from argo_compiler.hfsm.conditions import conditions_text
from argo_compiler.hfsm.model import DONE, MISSION
from argo_compiler.il import Stop
from argo_env.report.svg import Node, drawing, node, number, shorten

MAX_STATES = 45
"""leaves and groups of the largest machine that is drawn"""

NODE_WIDTH = 290.0  # px
SLOT = 19.0  # px, height of one way's label
GAP = 16.0  # px between rows
PAD = 14.0  # px between the borders of nested boxes
LANE = 11.0  # px between parallel ways
CHARACTER = 6.3  # px, width of a character of a label
MAX_LABEL = 46  # characters

_DECISION = "decide "
"""with a composite's id: the row in which its ways on are chosen"""

_INITIAL = "initial"
_AFTER_FAILURES = {TransitionKind.FAILURE: "failed", TransitionKind.MISSED: "time window missed"}


@dataclass
class _Row:
    """A row of the drawing. Holds the slots that are given away while the ways are laid out."""

    key: str
    kind: str
    text: str
    depth: int
    slots: list[int] = field(default_factory=list)
    """numbers of the ways that leave or enter on the right, from above"""
    y: float = 0.0

    @property
    def height(self) -> float:
        least = {"leaf": 34.0, "decision": 24.0, "head": 26.0}.get(self.kind, 22.0)
        return max(least, SLOT * len(self.slots) + 6)

    def slot(self, way: int) -> float:
        """y of the slot of a way."""
        offset = (self.height - SLOT * len(self.slots)) / 2
        return self.y + offset + SLOT * (self.slots.index(way) + 0.8)


@dataclass(frozen=True)
class _Way:
    source: str
    target: str
    kind: str
    label: str


def drawable(hfsm: Hfsm) -> bool:
    """Whether the machine is small enough to be read as a drawing."""
    return len(hfsm.leaves) + len(hfsm.composites) <= MAX_STATES


def machine(hfsm: Hfsm) -> Node:
    """The drawing of the machine: one `state` for each leaf and composite, one `way` for each
    transition."""
    rows = _rows(hfsm)
    place = {row.key: i for i, row in enumerate(rows)}
    ways = list(_ways(hfsm))
    straight = {
        i
        for i, way in enumerate(ways)
        if not way.label and _adjacent(rows, place[way.source], place[way.target])
    }
    for i, way in enumerate(ways):
        if i not in straight:
            rows[place[way.source]].slots.append(i)
            rows[place[way.target]].slots.append(i)
    y = 10.0
    for row in rows:
        row.y = y
        y += row.height + (GAP if row.kind != "head" else 8.0)
    depth = max(row.depth for row in rows)
    left = 10.0 + depth * PAD
    labels = left + NODE_WIDTH + depth * PAD + 12
    longest = max((len(way.label) for way in ways), default=0)
    lanes = labels + longest * CHARACTER + 14
    spans = {
        i: (rows[place[w.source]].slot(i), rows[place[w.target]].slot(i))
        for i, w in enumerate(ways)
        if i not in straight
    }
    lane = _lanes(spans)
    parts = _boxes(hfsm, rows, place, left)
    for i, way in enumerate(ways):
        source, target = rows[place[way.source]], rows[place[way.target]]
        if i in straight:
            parts.append(_straight(way, source, target, left))
        else:
            parts.append(_bent(way, (source, target), i, left, labels, lanes + lane[i] * LANE))
    # States come after the ways, so that a straight way passes below the title of a group.
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


def _ways(hfsm: Hfsm) -> Iterator[_Way]:
    yield _Way(_INITIAL, hfsm.mission.initial, "begin", "")
    for leaf in hfsm.leaves:
        for transition in leaf.transitions:
            yield _way(leaf.id, transition, None)
        for transition in filter(None, (leaf.failure, leaf.missed)):
            yield _way(leaf.id, transition, None)
    for group in hfsm.composites:
        for transition in group.transitions:
            yield _way(_DECISION + group.id, transition, group)
        if group.timeout:
            yield _way(group.id, group.timeout, group)


def _way(source: str, transition: StateTransition, group: Composite | None) -> _Way:
    completed = transition.completes
    target = transition.target or DONE if completed is None else _DECISION + completed
    return _Way(source, target, transition.kind, shorten(_label(transition, group), MAX_LABEL))


def _label(transition: StateTransition, group: Composite | None) -> str:
    if transition.kind is TransitionKind.CONDITIONAL:
        return conditions_text(transition.conditions)
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
        limits = [f"repeat until {conditions_text(group.repeat.until)}"]
    limits += [f"up to {group.repeat.count} rounds"] if group.repeat.count else []
    if group.repeat.duration:
        whole = ", whole rounds" if group.repeat.stop is Stop.SOFT else ""
        limits.append(f"for {group.repeat.duration:g} s{whole}")
    limits += [f"every {group.repeat.every:g} s"] if group.repeat.every else []
    return ", ".join(limits)


def _adjacent(rows: list[_Row], source: int, target: int) -> bool:
    """Whether only heads of groups lie between a row and one below it."""
    return source < target and all(row.kind == "head" for row in rows[source + 1 : target])


def _lanes(spans: dict[int, tuple[float, float]]) -> dict[int, int]:
    """A lane for each way, short ones inside, so that ways in one lane do not meet."""
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


def _boxes(hfsm: Hfsm, rows: list[_Row], place: dict[str, int], left: float) -> list[Node]:
    boxes = []
    for composite in hfsm.composites:
        first = place[composite.id]
        depth = rows[first].depth
        last = first
        while last + 1 < len(rows) and _inside(rows[last + 1], depth):
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


def _inside(row: _Row, depth: int) -> bool:
    """Whether the row belongs to the composite of that depth which lies right above."""
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


def _straight(way: _Way, source: _Row, target: _Row, left: float) -> Node:
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
        class_=f"way {way.kind}",
    )


def _bent(
    way: _Way, ends: tuple[_Row, _Row], index: int, left: float, labels: float, lane: float
) -> Node:
    start, end = (row.slot(index) for row in ends)
    if ends[0] is ends[1]:
        # A way back to its own row has one slot for both ends; listed twice, they lie side by side.
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
    if way.label:
        parts.append(node("text", x=labels, y=start - 4, text=way.label))
    return node("g", *parts, class_=f"way {way.kind}")
