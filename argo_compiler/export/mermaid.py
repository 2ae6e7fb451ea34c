"""A machine as a Mermaid state diagram, for documents and pages that render Mermaid."""

import re

from argo_compiler.export.diagram import Drawing, reaction_words, task_words
from argo_compiler.hfsm import Hfsm, Leaf

_END = "[*]"

_UNSAFE = re.compile(r"(?<=direction)\s|[^\w ,().-]", re.IGNORECASE)
"""What may mean something to Mermaid, which also takes `direction LR` inside of names."""


def to_mermaid(hfsm: Hfsm) -> str:
    """The machine as text of a `stateDiagram-v2`.

    Ids are made from positions (`t0` the first leaf, `g1` the first group), labels are the names.
    Beside each group stands a choice, `r1` for `g1`: what is decided there when a round ends. The
    reactions stand by themselves, as each of them may begin anywhere.
    """
    return "\n".join(_lines(Drawing(hfsm))) + "\n"


def _lines(drawing: Drawing) -> list[str]:
    initial = drawing.end(drawing.hfsm.mission.initial) or _END
    lines = ["stateDiagram-v2", *_states(drawing), *_reactions(drawing)]
    lines.append(f"    [*] --> {initial}")
    # All states come first and all transitions last, outside of every group: that is how
    # Mermaid accepts transitions between states of different groups.
    for arrow in drawing.arrows():
        label = f" : {_escape(arrow.label)}" if arrow.label else ""
        lines.append(f"    {arrow.source} --> {arrow.target or _END}{label}")
    return lines


def _states(drawing: Drawing) -> list[str]:
    lines: list[str] = []
    for depth, item in drawing.nested():
        indent = "    " * min(1 + depth, 20)
        if item is None:
            lines.append(f"{indent}}}")
        elif isinstance(item, Leaf):
            lines.append(
                f'{indent}state "{_escape(task_words(item.task))}" as {drawing.ids[item.id]}'
            )
        else:
            lines.append(f"{indent}state {drawing.choice(item.id)} <<choice>>")
            lines.append(f'{indent}state "{_escape(item.name)}" as {drawing.ids[item.id]} {{')
    return lines


def _reactions(drawing: Drawing) -> list[str]:
    reactions = drawing.hfsm.reactions
    if not reactions:
        return []
    states = (
        f'        state "{_escape(reaction_words(state.reaction))}" as e{i}'
        for i, state in enumerate(reactions, 1)
    )
    return ['    state "Reactions" as reactions {', *states, "    }"]


def _escape(text: str) -> str:
    """The text with Mermaid's entity codes for everything that is not plain."""
    return _UNSAFE.sub(lambda match: f"#{ord(match[0])};", text)
