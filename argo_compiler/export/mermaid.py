"""Export of the machine as a Mermaid state diagram, for documents that render Mermaid."""

import re

from argo_compiler.export.diagram import Diagram, reaction_label, task_label_with_limits
from argo_compiler.hfsm import Hfsm, Leaf

_END = "[*]"

_UNSAFE = re.compile(r"(?<=direction)\s|[^\w ,().-]", re.IGNORECASE)
"""Characters that may have a meaning in Mermaid, which also reads `direction LR` inside names."""


def to_mermaid(hfsm: Hfsm) -> str:
    """Return the machine as a Mermaid `stateDiagram-v2`.

    Ids are made from positions (`t0` the first leaf, `g1` the first group), labels are the names.
    Beside each group is a choice, `r1` for `g1`: the decision at the end of the group's round. The
    reactions are drawn apart from the tasks, as each reaction may start anywhere.
    """
    return "\n".join(_lines(Diagram(hfsm))) + "\n"


def _lines(diagram: Diagram) -> list[str]:
    initial = diagram.id_unless_mission_end(diagram.hfsm.mission.initial) or _END
    lines = ["stateDiagram-v2", *_states(diagram), *_reactions(diagram)]
    lines.append(f"    [*] --> {initial}")
    # Mermaid accepts transitions between states of different groups only if all states come first
    # and all transitions last, outside of every group.
    for arrow in diagram.transition_arrows():
        label = f" : {_escape(arrow.label)}" if arrow.label else ""
        lines.append(f"    {arrow.source} --> {arrow.target or _END}{label}")
    return lines


def _states(diagram: Diagram) -> list[str]:
    lines: list[str] = []
    for depth, item in diagram.elements_and_ends_with_depths():
        indent = "    " * min(1 + depth, 20)
        if item is None:
            lines.append(f"{indent}}}")
        elif isinstance(item, Leaf):
            label = _escape(task_label_with_limits(item.task))
            lines.append(f'{indent}state "{label}" as {diagram.ids[item.id]}')
        else:
            lines.append(f"{indent}state {diagram.round_end_choice_id(item.id)} <<choice>>")
            lines.append(f'{indent}state "{_escape(item.name)}" as {diagram.ids[item.id]} {{')
    return lines


def _reactions(diagram: Diagram) -> list[str]:
    reactions = diagram.hfsm.reactions
    if not reactions:
        return []
    states = (
        f'        state "{_escape(reaction_label(state.reaction))}" as e{i}'
        for i, state in enumerate(reactions, 1)
    )
    return ['    state "Reactions" as reactions {', *states, "    }"]


def _escape(text: str) -> str:
    """Return the text with Mermaid's entity codes for all characters with a possible meaning."""
    return _UNSAFE.sub(lambda match: f"#{ord(match[0])};", text)
