"""Graphviz: the machine as a DOT graph, with a cluster for each group."""

from argo_compiler.export.diagram import Arrow, Drawing, reaction_words, task_words
from argo_compiler.export.xml import printable
from argo_compiler.hfsm import Hfsm, Leaf


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
    for depth, item in drawing.nested():
        indent = "  " * min(1 + depth, 20)
        if item is None:
            lines.append(f"{indent}}}")
        elif isinstance(item, Leaf):
            lines.append(
                f"{indent}{drawing.ids[item.id]} [label={_quoted(task_words(item.task))}];"
            )
        else:
            # Beside the group: an arrow from a cluster's border can't end inside of it.
            lines.append(f'{indent}{drawing.choice(item.id)} [shape=diamond, label=""];')
            lines.append(f"{indent}subgraph cluster_{drawing.ids[item.id]} {{")
            lines.append(f"{indent}  label={_quoted(item.name)};")
    if hfsm.reactions:
        lines += ["  subgraph cluster_reactions {", '    label="Reactions"; style=dashed;']
        for i, state in enumerate(hfsm.reactions, 1):
            lines.append(f"    e{i} [shape=note, label={_quoted(reaction_words(state.reaction))}];")
        lines.append("  }")
    lines.append(f"  start -> {drawing.end(hfsm.mission.initial) or 'done'};")
    lines += (f"  {_edge(drawing, arrow)}" for arrow in drawing.arrows())
    return [*lines, "}"]


def _edge(drawing: Drawing, arrow: Arrow) -> str:
    source, attributes = arrow.source, [f"label={_quoted(arrow.label)}"] if arrow.label else []
    if arrow.leaves:
        # From the group's border, which only clusters have, so from some task inside.
        source = drawing.ids[drawing.first_leaf(arrow.leaves)]
        attributes.append(f"ltail=cluster_{arrow.source}")
    told = f" [{', '.join(attributes)}]" if attributes else ""
    return f"{source} -> {arrow.target or 'done'}{told};"


def _quoted(text: str) -> str:
    """The text as a quoted string, in which DOT's escapes mean nothing."""
    plain = printable(text).replace("\\", "\\\\").replace('"', '\\"')
    # Entities would be taken for the characters that they stand for.
    plain = plain.replace("&", "&amp;")
    return '"' + plain.replace("\r", " ").replace("\t", " ").replace("\n", "\\n") + '"'
