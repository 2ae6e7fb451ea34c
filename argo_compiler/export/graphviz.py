"""Export of the machine as a DOT graph for Graphviz, with a cluster for each group."""

from argo_compiler.export.diagram import Arrow, Diagram, reaction_label, task_label_with_limits
from argo_compiler.export.xml import escape_forbidden_characters
from argo_compiler.hfsm import Hfsm, Leaf


def to_dot(hfsm: Hfsm) -> str:
    """Return the machine as a DOT graph.

    Ids are made from positions, labels are the names. A diamond beside a group stands for the
    decision at the end of the group's round.
    """
    return "\n".join(_lines(hfsm)) + "\n"


def _lines(hfsm: Hfsm) -> list[str]:
    diagram = Diagram(hfsm)
    lines = [
        "digraph mission {",
        "  compound=true;",
        '  node [shape=box, style=rounded, fontname="sans-serif"];',
        '  edge [fontname="sans-serif", fontsize=10];',
        f"  label={_quoted(hfsm.mission.name)};",
        '  start [shape=point, width=0.15, label=""];',
        '  done [shape=doublecircle, width=0.15, label=""];',
    ]
    for depth, item in diagram.elements_and_ends_with_depths():
        indent = "  " * min(1 + depth, 20)
        if item is None:
            lines.append(f"{indent}}}")
        elif isinstance(item, Leaf):
            label = _quoted(task_label_with_limits(item.task))
            lines.append(f"{indent}{diagram.ids[item.id]} [label={label}];")
        else:
            # Outside of the cluster, as an edge from a cluster's border can't end inside it.
            lines.append(
                f'{indent}{diagram.round_end_choice_id(item.id)} [shape=diamond, label=""];'
            )
            lines.append(f"{indent}subgraph cluster_{diagram.ids[item.id]} {{")
            lines.append(f"{indent}  label={_quoted(item.name)};")
    if hfsm.reactions:
        lines += ["  subgraph cluster_reactions {", '    label="Reactions"; style=dashed;']
        for i, state in enumerate(hfsm.reactions, 1):
            lines.append(f"    e{i} [shape=note, label={_quoted(reaction_label(state.reaction))}];")
        lines.append("  }")
    lines.append(f"  start -> {diagram.id_unless_mission_end(hfsm.mission.initial) or 'done'};")
    lines += (f"  {_edge(diagram, arrow)}" for arrow in diagram.transition_arrows())
    return [*lines, "}"]


def _edge(diagram: Diagram, arrow: Arrow) -> str:
    source, attributes = arrow.source, [f"label={_quoted(arrow.label)}"] if arrow.label else []
    if arrow.source_group:
        # Only nodes have edges: start at a task inside and clip the edge at the cluster's border.
        source = diagram.ids[diagram.first_leaf_id(arrow.source_group)]
        attributes.append(f"ltail=cluster_{arrow.source}")
    attribute_list = f" [{', '.join(attributes)}]" if attributes else ""
    return f"{source} -> {arrow.target or 'done'}{attribute_list};"


def _quoted(text: str) -> str:
    """Return the text as a quoted string in which DOT interprets no escape sequences."""
    plain = escape_forbidden_characters(text).replace("\\", "\\\\").replace('"', '\\"')
    # Graphviz would replace XML entities by the characters that they stand for.
    plain = plain.replace("&", "&amp;")
    return '"' + plain.replace("\r", " ").replace("\t", " ").replace("\n", "\\n") + '"'
