"""Text of the lines of a draft that are left to decide on."""

import os
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from argo_planner.terminal.draft_files import draft_path

if TYPE_CHECKING:
    from argo_compiler.script import Draft, DraftLine, IncompleteDraft

_SHOWN = 20
"""lines of a draft that are shown; a file has all of them"""
_CHOICES_SHOWN = 4
"""choices of a line that are shown, if a file has all of them"""


def incomplete_text(error: "IncompleteDraft") -> str:
    """Return what is left to decide on in a draft, and how that is done."""
    from argo_planner.terminal.words import diagnostics_text

    draft = error.draft
    parts = [diagnostics_text(draft.diagnostics, draft.source_name)] if draft.diagnostics else []
    return "\n".join([*parts, left_text(draft)])


def left_text(draft: "Draft") -> str:
    """Return the lines of a draft that are left, how many they are, and the way to decide."""
    from argo_compiler.script import IncompleteDraft, LineState

    proposed = [line for line in draft.left if line.state is LineState.PROPOSED]
    path = draft_path(Path(draft.source_name))
    parts = _lines_text(draft.left, path)
    parts.append(str(IncompleteDraft(draft)))
    if draft.left:
        parts.append(_commands(draft, proposed))
    return "\n".join(parts)


def _lines_text(lines: Sequence["DraftLine"], path: Path | None) -> list[str]:
    kept = path is not None and os.path.exists(path)
    most = _CHOICES_SHOWN if kept else None
    shown = [text for line in lines[:_SHOWN] for text in _line_text(line, most)]
    left = len(lines) - _SHOWN
    shown += [f"({left} more lines)"] if left > 0 else []
    return [*shown, f"all lines and choices are in {path}"] if kept and lines else shown


def _line_text(line: "DraftLine", most: int | None) -> Iterable[str]:
    known = line.place == f"line {line.line}"
    place = f" ({line.place})" if line.place and not known else ""
    yield f"line {line.label}{place}: {printable(line.text)}"
    if line.sentences or not line.reason:
        yield f"    => {' '.join(line.sentences) or '(nothing)'}"
    if line.reason and (line.place or line.sentences):  # else a message has it
        yield f"    {line.reason}"
    for number, sentences in enumerate(line.choices[:most], start=1):
        yield f"    choice {number}: {' '.join(sentences) or '(set it aside)'}"
    more = len(line.choices[:most]) < len(line.choices)
    if more:
        yield f"    (choices up to {len(line.choices)})"
    if line.unused:
        yield f"    not used: {printable(', '.join(line.unused))}"


def printable(text: str) -> str:
    """Return a text without characters that would control a terminal."""
    return "".join(c if c.isprintable() else " " for c in text)


def _commands(draft: "Draft", proposed: Sequence["DraftLine"]) -> str:
    """Return the command that decides on the lines that are left."""
    opened = [line for line in draft.left if line not in proposed]
    kept = draft_path(Path(draft.source_name)) is not None
    options = []
    if proposed:
        options.append(f"--confirm {labels_text([line.label for line in proposed])}")
    # What is kept can be decided line by line.
    options += [_option(line) for line in opened[: 1 if kept else _SHOWN]]
    decide = f"`argo import {shlex.quote(draft.source_name)} -o MISSION {' '.join(options)}`"
    if kept:
        return f"decide with {decide}, or add --interactive"
    return f"decide in one command, as no draft of standard input is kept: {decide}"


def _option(line: "DraftLine") -> str:
    """Return an option that decides on an open line."""
    number = next((n for n, said in enumerate(line.choices, start=1) if said), None)
    if number is not None:
        return f"--choose {line.label}={number}"
    return f'--say {line.label} "..." (or --set-aside {line.label})'


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
