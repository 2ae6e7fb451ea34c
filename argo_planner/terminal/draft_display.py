"""Text of the lines of a draft that are left to decide on."""

import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_compiler.script import Draft, DraftLine, IncompleteDraft

_SHOWN = 20
"""lines of a draft that are shown; a file has all of them"""


def incomplete_text(error: "IncompleteDraft") -> str:
    """Return what is left to decide on in a draft, and how that is done."""
    from argo_planner.terminal.words import diagnostics_text

    draft = error.draft
    parts = [diagnostics_text(draft.diagnostics, draft.source_name)] if draft.diagnostics else []
    return "\n".join([*parts, left_text(draft)])


def left_text(draft: "Draft") -> str:
    """Return the proposed lines of a draft, how many lines are left, and the way to decide.

    Of a document all lines that are left are shown, as messages have their places, not numbers.
    """
    from argo_compiler.script import IncompleteDraft, LineState

    proposed = [line for line in draft.left if line.state is LineState.PROPOSED]
    parts = _lines_text(draft.left if any(line.place for line in draft.left) else proposed)
    parts.append(str(IncompleteDraft(draft)))
    if draft.left:
        parts.append(_commands(draft, proposed))
    return "\n".join(parts)


def _lines_text(lines: Sequence["DraftLine"]) -> list[str]:
    shown = [text for line in lines[:_SHOWN] for text in _line_text(line)]
    left = len(lines) - _SHOWN
    return [*shown, f"({left} more)"] if left > 0 else shown


def _line_text(line: "DraftLine") -> Iterable[str]:
    place = f" ({line.place})" if line.place else ""
    yield f"line {line.label}{place}: {line.text}"
    if line.reason and not line.sentences:
        yield f"    {line.reason}"
    else:
        yield f"    => {' '.join(line.sentences) or '(nothing)'}"
    for number, sentences in enumerate(line.choices if line.place else (), start=1):
        yield f"    choice {number}: {' '.join(sentences) or '(set it aside)'}"
    if line.unused:
        yield f"    not used: {', '.join(line.unused)}"


def _commands(draft: "Draft", proposed: Sequence["DraftLine"]) -> str:
    """Return the command that decides on the lines that are left."""
    opened = [line for line in draft.left if line not in proposed]
    options = []
    if proposed:
        options.append(f"--confirm {labels_text([line.label for line in proposed])}")
    if opened:
        label = opened[0].label
        if opened[0].choices:
            options.append(f"--choose {label}=1")
        else:
            options.append(f'--say {label} "..." (or --set-aside {label})')
    name = shlex.quote(draft.source_name)
    return f"decide with `argo import {name} -o MISSION {' '.join(options)}`"


def labels_text(labels: Sequence[str]) -> str:
    """Return labels of lines as ranges: `3,7-9`."""
    ranges: list[list[str]] = []
    for label in labels:
        last = ranges[-1][-1] if ranges else ""
        if last.isdecimal() and label.isdecimal() and int(label) == int(last) + 1:
            ranges[-1].append(label)
        else:
            ranges.append([label])
    return ",".join(r[0] if len(r) == 1 else f"{r[0]}-{r[-1]}" for r in ranges)


def draft_path(script: Path) -> Path:
    """Return where the draft of a script is kept: beside it."""
    return script.with_name(f"{script.name}.draft")
