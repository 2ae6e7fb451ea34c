"""Graphviz: the machine as a DOT graph, with a cluster for each group."""

from argo_compiler.export.diagram import Drawing, reaction_words, transition_words
from argo_compiler.export.xml import printable
from argo_compiler.hfsm import Composite, Hfsm, Leaf, Transition
from argo_compiler.hfsm.model import DONE


def to_dot(hfsm: Hfsm) -> str:
    """The machine as text for `dot`.

    Ids are made from positions, labels are the names. A diamond beside a group is what is decided
    when a round of it ends.
    """
    return "\n".join(_lines(hfsm)) + "\n"


def _lines(hfsm: Hfsm) -> list[str]:
    drawing = Drawing(hfsm)
    lines = [
        "digraph mission {",
        "  compound=true;",
        '  node [shape=box, style=rounded, fontname="sans-serif"];',
        '  edge [fontname="sans-serif", fontsize=10];',
        f"  label={_quoted(hfsm.mission.name)};",
        '  start [shape=point, width=0.15, label=""];',
        '  done [shape=doublecircle, width=0.15, label=""];',
    ]
    depth = 1
    for item in drawing.nested():
        indent = "  " * min(depth, 20)
        if item is None:
            depth -= 1
            lines.append("  " * min(depth, 20) + "}")
        elif isinstance(item, Leaf):
            lines.append(f"{indent}{drawing.ids[item.id]} [label={_quoted(item.task.name)}];")
        else:
            # Beside the group: an arrow from a cluster's border can't end inside of it.
            lines.append(f'{indent}{drawing.choice(item.id)} [shape=diamond, label=""];')
            lines.append(f"{indent}subgraph cluster_{drawing.ids[item.id]} {{")
            lines.append(f"{indent}  label={_quoted(item.name)};")
            depth += 1
    if hfsm.reactions:
        lines += ["  subgraph cluster_reactions {", '    label="Reactions"; style=dashed;']
        for i, state in enumerate(hfsm.reactions, 1):
            lines.append(f"    e{i} [shape=note, label={_quoted(reaction_words(state.reaction))}];")
        lines.append("  }")
    lines.append(f"  start -> {_target(drawing, hfsm.mission.initial)};")
    lines += (f"  {edge}" for edge in _edges(drawing))
    return [*lines, "}"]


def _edges(drawing: Drawing) -> list[str]:
    edges: list[str] = []
    for leaf in drawing.hfsm.leaves:
        source = drawing.ids[leaf.id]
        edges += (_edge(drawing, source, t) for t in leaf.transitions)
        if leaf.failure:
            edges.append(_edge(drawing, source, leaf.failure))
    for group in drawing.hfsm.composites[1:]:
        edges += (_edge(drawing, drawing.choice(group.id), t, group) for t in group.transitions)
        if group.timeout:
            # From the group's border, which only clusters have, so from some task inside.
            inside = drawing.ids[drawing.first_leaf(group)]
            border = f"ltail=cluster_{drawing.ids[group.id]}"
            edges.append(_edge(drawing, inside, group.timeout, group, border))
    return edges


def _edge(
    drawing: Drawing,
    source: str,
    transition: Transition,
    group: Composite | None = None,
    tail: str = "",
) -> str:
    if transition.completes is not None:
        target = drawing.choice(transition.completes)
    else:
        target = _target(drawing, transition.target or DONE)
    label = transition_words(transition, group)
    attributes = [part for part in (f"label={_quoted(label)}" if label else "", tail) if part]
    return f"{source} -> {target}" + (f" [{', '.join(attributes)}]" if attributes else "") + ";"


def _target(drawing: Drawing, id: str) -> str:
    return "done" if id == DONE else drawing.ids[id]


def _quoted(text: str) -> str:
    """The text as a quoted string, in which DOT's escapes mean nothing."""
    plain = printable(text).replace("\\", "\\\\").replace('"', '\\"')
    # Entities would be taken for the characters that they stand for.
    plain = plain.replace("&", "&amp;")
    return '"' + plain.replace("\r", " ").replace("\t", " ").replace("\n", "\\n") + '"'
