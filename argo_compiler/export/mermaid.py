"""A machine as a Mermaid state diagram, for documents and pages that render Mermaid."""

import re

from argo_compiler.export.diagram import Drawing, reaction_words, transition_words
from argo_compiler.hfsm import Composite, Hfsm, Leaf, Transition
from argo_compiler.hfsm.model import DONE

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
    initial = _target(drawing, drawing.hfsm.mission.initial)
    lines = ["stateDiagram-v2", *_states(drawing), *_reactions(drawing)]
    lines.append(f"    [*] --> {initial}")
    # All states come first and all transitions last, outside of every group: that is how
    # Mermaid accepts transitions between states of different groups.
    for leaf in drawing.hfsm.leaves:
        source = drawing.ids[leaf.id]
        lines += (_arrow(drawing, source, t) for t in leaf.transitions)
        if leaf.failure:
            lines.append(_arrow(drawing, source, leaf.failure))
    for group in drawing.hfsm.composites[1:]:
        choice = drawing.choice(group.id)
        lines += (_arrow(drawing, choice, t, group) for t in group.transitions)
        if group.timeout:
            lines.append(_arrow(drawing, drawing.ids[group.id], group.timeout, group))
    return lines


def _states(drawing: Drawing) -> list[str]:
    lines: list[str] = []
    depth = 1
    for item in drawing.nested():
        indent = "    " * min(depth, 20)
        if item is None:
            depth -= 1
            lines.append("    " * min(depth, 20) + "}")
        elif isinstance(item, Leaf):
            lines.append(f'{indent}state "{_escape(item.task.name)}" as {drawing.ids[item.id]}')
        else:
            lines.append(f"{indent}state {drawing.choice(item.id)} <<choice>>")
            lines.append(f'{indent}state "{_escape(item.name)}" as {drawing.ids[item.id]} {{')
            depth += 1
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


def _arrow(
    drawing: Drawing, source: str, transition: Transition, group: Composite | None = None
) -> str:
    if transition.completes is not None:
        target = drawing.choice(transition.completes)
    else:
        target = _target(drawing, transition.target or DONE)
    label = transition_words(transition, group)
    return f"    {source} --> {target}" + (f" : {_escape(label)}" if label else "")


def _target(drawing: Drawing, id: str) -> str:
    return "[*]" if id == DONE else drawing.ids[id]


def _escape(text: str) -> str:
    """The text with Mermaid's entity codes for everything that is not plain."""
    return _UNSAFE.sub(lambda match: f"#{ord(match[0])};", text)
