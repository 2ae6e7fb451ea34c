"""Judges the drafts of documents by what a careful reader takes each document for.

A person is played who confirms all that is proposed, and answers each question with "leave it out";
nothing is written in other words. NAME.json beside a document says what must come of it.
"""

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Severity
from argo_compiler.il import Mission
from argo_compiler.script import Draft, DraftLine, LineState, import_script, read_document
from tests.argo_compiler.script.judging.driving import Drive

_MOST_TURNS = 12
_WORDS = {"one": 1, "two": 2, "five": 5, "ten": 10}
_NUMBER = rf"(\d+|{'|'.join(_WORDS)})"
_START = re.compile(r"start (?:from|docked in) starting area (\d)")
_END = re.compile(r"end docked in starting area (\d)")
_LIMIT = re.compile(r"at most (\d+) minutes")
_APART = re.compile(rf"#(\d+) is read twice, {_NUMBER} minutes? apart")
_WAIT = re.compile(rf"{_NUMBER} minutes?' wait after #(\d+), before #(\d+)")
_BRANCH = re.compile(
    r"if (?:valve \w+ \()?#(?P<point>\d+)\)? "
    r"(?:reads (?P<side>above|below) (?P<limit>[\d.]+)[^,]*|is not open), "
    rf"(?:measure|read) #(?P<also>\d+)(?: once more (?P<later>{_NUMBER}) minutes later)?"
)
_CELLS = re.compile(r"(?:(\w[\w ]*)!)?\b([A-Z])(\d+)(?::([A-Z])(\d+))?\b")
_ROW = re.compile(r"\b(?:row|line) (\d+)")
_QUOTED = re.compile(r"'([^']+)'")
_OUTSIDE = {"above": 0.5, "below": -0.5}


@dataclass(frozen=True)
class Document:
    """A document, and what it has to become."""

    path: Path
    expected: dict[str, Any]


def load_documents(folder: Path) -> list[Document]:
    """Return the documents of a folder, by name."""
    found = [
        Document(path, json.loads(path.with_suffix(".json").read_text(encoding="utf-8")))
        for path in sorted(folder.iterdir())
        if path.suffix in (".xlsx", ".docx", ".pdf", ".csv", ".tsv")
    ]
    return [document for document in found if "checkpoints" in document.expected]


def judge_document(document: Document, catalog: Catalog) -> list[str]:
    """Return what is wrong with the draft and the mission of a document."""
    expected = document.expected
    script = read_document(document.path)
    area = None if any(_START.search(text) for text in expected["conditions"]) else 1

    def read(decisions: tuple = ()) -> Draft:
        name = document.path.name
        return import_script(
            script, catalog, source_name=name, start_area=area, decisions=decisions
        )

    draft = read()
    problems = [*_not_asked(draft, expected), *_wrong_ranges(draft, expected, catalog)]
    for _ in range(_MOST_TURNS):
        if not draft.left:
            break
        if any(line.state is LineState.PROPOSED for line in draft.left):
            draft = read(draft.confirm())
        else:
            draft = read(draft.set_aside([line.label for line in draft.left]))
    if draft.mission is None:
        errors = [d.message for d in draft.diagnostics if d.severity is Severity.ERROR]
        return [*problems, f"no mission: {errors}"]
    return [*problems, *_wrong_mission(draft.mission, expected, catalog)]


# ---- questions


def _not_asked(draft: Draft, expected: dict[str, Any]) -> Iterator[str]:
    """Yield the entries that no line asks about."""
    left = [line for line in draft.left if not _does_something(line)]
    for entry in expected["asked"]:
        if not any(_is_about(entry, line) for line in left):
            yield f"not asked: {entry}"


def _does_something(line: DraftLine) -> bool:
    """Return True if a line is proposed as something else than to leave a checkpoint out."""
    return any("not check" not in sentence for sentence in line.sentences)


def _is_about(entry: str, line: DraftLine) -> bool:
    """Return True if a line is at the place of an entry, or has words that it quotes."""
    quoted = (" ".join(text.split()) for text in _QUOTED.findall(entry))
    if any(text.lower() in _plain(line) for text in quoted):
        return True
    for sheet, column, first, _, last in _CELLS.findall(entry):
        rows = range(int(first), int(last or first) + 1)
        named = _CELLS.findall(f"{line.place} {line.reason}")
        if any(int(row) in rows and (not sheet or s in ("", sheet)) for s, _, row, _, _ in named):
            return bool(column)
    numbers = {int(number) for number in _ROW.findall(entry)}
    if numbers & {int(number) for number in re.findall(r"\d+", line.place)}:
        return True
    said = {f"#{number}" for number in re.findall(r"#(\d+)", entry)}
    asked = {f"#{n}" for choice in line.choices for n in re.findall(r"\d+", " ".join(choice))}
    return bool(said & asked)


def _plain(line: DraftLine) -> str:
    return re.sub(r"[.?!]", "", line.text).lower() + line.text.lower()


# ---- normal ranges


def _wrong_ranges(draft: Draft, expected: dict[str, Any], catalog: Catalog) -> Iterator[str]:
    """Yield the checkpoints whose other range is not reported, or is without reason."""
    names = {checkpoint.id: checkpoint.name for checkpoint in catalog.checkpoints}
    told = [d.message for d in draft.diagnostics if d.code == "script.other-range"]
    found = {i for i, name in names.items() if any(f"{name} is" in text for text in told)}
    wanted = {*expected["ranges_differ"]}
    if found != wanted:
        yield f"other ranges are reported of {sorted(found)}, not {sorted(wanted)}"


# ---- the mission


def _wrong_mission(mission: Mission, expected: dict[str, Any], catalog: Catalog) -> Iterator[str]:
    wanted = [f"M{id}" for id in expected["checkpoints"]]
    steps = [step.token for step in Drive(mission, catalog, {"values": _normal(catalog)}).run()]
    found = [token for token in steps if token[0] == "M"]
    free = expected["any_order"]
    if (Counter(found) != Counter(wanted)) if free else (found != wanted):
        yield f"measures {found}, not {wanted}"
    if free != (mission.order == "any"):
        yield f"the order is {mission.order}"
    for text in expected["conditions"]:
        if (problem := _broken(text, mission, steps, catalog)) is not None:
            yield f"{problem}: {text}"


def _normal(catalog: Catalog) -> dict[str, float]:
    return {str(c.id): (c.nominal.low + c.nominal.high) / 2 for c in catalog.checkpoints}


def _broken(text: str, mission: Mission, steps: list[str], catalog: Catalog) -> str | None:
    """Return how a mission breaks a condition; None if it does not."""
    start, limit = _START.search(text), _LIMIT.search(text)
    end = _END.search(text) or (start if start and "end there" in text else None)
    if start and mission.start_area != int(start[1]):
        return f"starts in area {mission.start_area}"
    if end and (mission.end_area != int(end[1]) or f"D{end[1]}" not in steps[-1:]):
        return f"ends in area {mission.end_area}, {steps[-1:]}"
    if limit and mission.max_duration != 60 * int(limit[1]):
        return f"takes at most {mission.max_duration} s"
    if apart := _APART.search(text):
        return _missing([f"M{apart[1]}", _pause(apart[2]), f"M{apart[1]}"], steps)
    if wait := _WAIT.search(text):
        return _missing([f"M{wait[2]}", _pause(wait[1]), f"M{wait[3]}"], steps)
    if branch := _BRANCH.search(text):
        values = _normal(catalog)
        values[branch["point"]] = (
            float(branch["limit"]) + _OUTSIDE[branch["side"]] if branch["side"] else 0.0
        )
        taken = [step.token for step in Drive(mission, catalog, {"values": values}).run()]
        pause = [_pause(branch["later"])] if branch["later"] else []
        return _missing([f"M{branch['point']}", *pause, f"M{branch['also']}"], taken)
    return None


def _pause(said: str) -> str:
    return f"P{60 * _WORDS.get(said, 0) or 60 * int(said)}"


def _missing(wanted: list[str], steps: list[str]) -> str | None:
    places = range(len(steps) - len(wanted) + 1)
    found = any(steps[i : i + len(wanted)] == wanted for i in places)
    return None if found else f"does {steps}, without {wanted}"
