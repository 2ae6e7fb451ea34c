"""Judges the draft of a script by what a careful reader takes each line for.

A person is played who confirms what is proposed, takes the choice that means the same as the
expectation, and sets all else aside; nothing is written in other words.
"""

import json
import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission
from argo_compiler.script import Draft, DraftLine, LineState, import_script

_MOST_TURNS = 12
_POINT = re.compile(r"(?:#|checkpoint )(\d+)")
_CASE = re.compile(r"\b(?:if|when|unless|at least)\b", re.IGNORECASE)
_SPARED = re.compile(r"left out|without|do not|delete", re.IGNORECASE)
_EXCEPT = re.compile(r"\b(?:except|but not) [^:.;]*", re.IGNORECASE)
"""in what a line means: which checkpoints are none of those that are named behind it"""
_OF_HEADER = (
    re.compile(r"\bstarts? (?:docked )?in (?:the )?starting area (\d)", re.IGNORECASE),
    re.compile(r"\b(?:return|end)[^.]*?starting area (\d)", re.IGNORECASE),
    re.compile(r"\bwait (?:for )?(\d+)", re.IGNORECASE),
    re.compile(r"\b(?:at most|maximum duration:?) (\d+)", re.IGNORECASE),
)
"""what a line without checkpoints may mean: where the mission starts and ends, waits, limits"""
_DOCKS = r"(?:\bdock|starting area)"
_RETRIES = r"\b(?:re)?tr(?:y|ies)\b"
_GOES_ON = r"\b(?:skip|leave (?:it )?out|(?:go|continue) (?:on )?with the next)"
_OF_CASE = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        _DOCKS,
        rf"^(?!.*{_DOCKS}).*\b(?:end|abort)",
        _RETRIES,
        rf"^(?!.*{_RETRIES}).*{_GOES_ON}",
        r"\b(?:wait|pause)\b",
        r"\bcharge",
        r"\breport",
    )
)
"""what is done in a case that names no checkpoint; after another try the mission goes on anyway"""
_MOVED = re.compile(r"\b(?:first|last|before|after|between)\b", re.IGNORECASE)
_MOVES = re.compile(r"(?:Add|Move) ")
_IN_BRACKETS = re.compile(r"\([^()]*\)")
"""in what a line means: the other name of a point, or another reading"""
_FREE = re.compile(r"in any order|\border (?:of [^.]*)?is free|order: any", re.IGNORECASE)
_ORDER = -9000
"""stands for a free order"""
_TO = re.compile(r"#(\d+) to #(\d+)")
_ASKED = ("asked", "open")
_NEEDED = re.compile(r"duration|area|docking|order is|stands for|rounds|When|If")
"""in what a line means: it has an effect without naming a checkpoint"""
_OF_OTHERS = re.compile(r"replaced|because of|further task")
"""in what a line means: another line has the same effect"""

Meaning = Counter[tuple[bool, int]]
"""the checkpoints of sentences, and whether they are spared; 0 stands for a condition"""


@dataclass
class Verdict:
    """What is wrong with a draft, and how many acts it took to complete it."""

    problems: list[str] = field(default_factory=list)
    acts: int = 0
    lines: int = 0


@dataclass(frozen=True)
class ExpectedLine:
    must: str
    means: str | None


@dataclass(frozen=True)
class Case:
    """A script, and what it has to become."""

    name: str
    text: str
    lines: dict[int, ExpectedLine]
    mission: dict[str, Any]
    tags: dict[str, int]


def load_cases(folder: Path) -> list[Case]:
    """Return the scripts of a folder, by name."""
    return [_load(path) for path in sorted(folder.glob("*.txt"))]


def _load(path: Path) -> Case:
    expected = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
    lines = {
        number: ExpectedLine(entry["must"], entry.get("means"))
        for entry in expected["lines"]
        for number in entry.get("lines", [entry.get("line")])
    }
    text = path.read_text(encoding="utf-8")
    return Case(path.stem, text, lines, expected["mission"], expected.get("site_tags", {}))


def judge_draft(
    case: Case, catalog: Catalog, without_words: Collection[int] = frozenset()
) -> Verdict:
    """Return what is wrong with the draft of a script. For what the lines `without_words` mean the
    mission language has no words: they have to be open."""
    verdict = Verdict(lines=sum(bool(line.strip()) for line in case.text.splitlines()))
    catalog = _tagged(catalog, case.tags)
    meaning = _Meanings(catalog)
    area = None if case.mission["start_area"] else 1
    draft = import_script(case.text, catalog, start_area=area)
    errors = {d.code for d in draft.diagnostics}
    if "script.area-conflict" in errors:
        area = None  # it starts at another place
    end_area = 1 if any("leaves the end open" in d.message for d in draft.diagnostics) else None
    options = {"start_area": area, "end_area": end_area}
    draft = import_script(case.text, catalog, **options)
    verdict.problems += _wrong_states(draft, case, meaning)
    asked = {line.line for line in draft.left if line.state is LineState.OPEN}
    verdict.problems += [f"line {n} is no longer open" for n in sorted({*without_words} - asked)]
    decisions: tuple = ()
    for _ in range(_MOST_TURNS):
        draft = import_script(case.text, catalog, decisions=decisions, **options)
        if not draft.left:
            break
        proposed = [line for line in draft.left if line.state is LineState.PROPOSED]
        if proposed:
            verdict.acts += len(proposed)
            decisions = draft.confirm()
            continue
        verdict.acts += 1
        decisions = _answered(draft, case, verdict, meaning, without_words)
    if draft.left:
        verdict.problems.append(f"not complete: {[line.label for line in draft.left]}")
    elif draft.mission is None:
        errors = [d.message for d in draft.diagnostics if d.severity == "error"]
        verdict.problems.append(f"no mission: {errors}")
    else:
        verdict.problems += _wrong_mission(draft.mission, case.mission)
    return verdict


def _tagged(catalog: Catalog, tags: dict[str, int]) -> Catalog:
    """Return the catalogue of a site that has these tags."""
    checkpoints = tuple(
        c.model_copy(update={"tags": tuple(tag for tag, id in tags.items() if id == c.id)})
        if c.id in tags.values()
        else c
        for c in catalog.checkpoints
    )
    return catalog.model_copy(update={"checkpoints": checkpoints})


def _wrong_states(draft: Draft, case: Case, meaning: "_Meanings") -> Iterable[str]:
    """Yield the lines whose state their expectation does not allow."""
    for number, expected in case.lines.items():
        at = [line for line in draft.lines if line.line <= number <= line.last_line]
        states = {line.state for line in at}
        if not at and expected.must != "set aside":
            yield f"line {number}: in no line of the draft"
        if expected.must in _ASKED and LineState.OPEN not in states:
            yield f"line {number}: must be {expected.must}, is {', '.join(states)}"
        if expected.must == "set aside":
            made = [s for line in at for s in line.sentences if _POINT.search(s)]
            if made:
                yield f"line {number}: must be set aside, becomes {made}"
            continue
        if expected.means is None or LineState.OPEN in states:
            continue
        made = [s for line in at for s in line.sentences]
        covered = {n for line in at for n in range(line.line, line.last_line + 1)}
        means = [case.lines[n].means or "" for n in covered & case.lines.keys()]
        if any(map(_OF_OTHERS.search, means)):
            continue
        if made and meaning(means) and meaning(made) - meaning(means):
            yield f"line {number}: means `{expected.means}`, becomes {made}"


def _answered(
    draft: Draft,
    case: Case,
    verdict: Verdict,
    meaning: "_Meanings",
    without_words: Collection[int],
) -> tuple:
    """Return the decisions with the first open line answered."""
    line = draft.left[0]
    numbers = [n for n in range(line.line, line.last_line + 1) if n in case.lines]
    all_expected = [case.lines[number] for number in numbers]
    effective = [one for one in all_expected if one.must != "set aside"]
    expected = next(iter(effective or all_expected), ExpectedLine("set aside", None))
    wanted = None if line.line in without_words else expected.means
    if wanted:
        means = meaning([wanted])
        for number, sentences in enumerate(line.choices, start=1):
            if _changes_as(wanted, sentences, meaning):
                return draft.choose(line.label, number)
        for number, sentences in enumerate(line.choices, start=1):
            if sentences and meaning.whole(sentences) == meaning.whole([wanted]):
                return draft.choose(line.label, number)
        if sum(other.means == wanted for other in case.lines.values()) > 1:
            return _part_of(means, draft, line, meaning)
        needed = meaning([wanted]) or _NEEDED.search(wanted)
        if expected.must.startswith("understood") and needed:
            verdict.problems.append(f"line {line.label} has no choice `{wanted}`: {line.reason}")
    return draft.set_aside([line.label])


def _changes_as(wanted: str, sentences: Sequence[str], meaning: "_Meanings") -> bool:
    """Return True if a choice moves the checkpoint that a line moves; the mission shows whether it
    is moved to the right place."""
    if len(sentences) != 1 or not _MOVED.search(wanted) or not _MOVES.match(sentences[0]):
        return False
    names = _POINT.findall(sentences[0])
    return any(meaning([wanted])[False, int(number)] for number in names[:1])


def _part_of(means: Meaning, draft: Draft, line: DraftLine, meaning: "_Meanings") -> tuple:
    """Return the decisions for a line that shares what it means with others: it becomes as much of
    that as it can, or nothing; the mission shows whether anything is missing."""
    parts = [
        (meaning(sentences).total(), -number)
        for number, sentences in enumerate(line.choices, start=1)
        if meaning(sentences) and not meaning(sentences) - means
    ]
    if not parts:
        return draft.set_aside([line.label])
    return draft.choose(line.label, -max(parts)[1])


def _expanded(found: re.Match[str]) -> str:
    """Return all of `#1 to #4`."""
    return " ".join(f"#{number}" for number in range(int(found[1]), int(found[2]) + 1))


class _Meanings:
    """Tells which checkpoints sentences name, by number or by name."""

    def __init__(self, catalog: Catalog) -> None:
        self._ids = {c.name.lower(): c.id for c in catalog.checkpoints}
        longest_first = sorted(self._ids, key=len, reverse=True)
        self._named = re.compile(rf"\b(?:{'|'.join(longest_first)})\b", re.IGNORECASE)

    def whole(self, sentences: Sequence[str]) -> Meaning:
        """Return the meaning; of sentences without checkpoints, what they set or wait for."""
        found = self(sentences)
        text = " ".join(sentences)
        if found.keys() == {(False, 0)}:
            found.update(
                (False, -k) for k, pattern in enumerate(_OF_CASE, 1) if pattern.search(text)
            )
        if not found:
            for kind, pattern in enumerate(_OF_HEADER, start=1):
                found.update((False, -1000 * kind - int(n)) for n in pattern.findall(text))
        return found

    def __call__(self, sentences: Sequence[str]) -> Meaning:
        """Return the checkpoints, which are spared, and how many conditions there are."""
        found: Meaning = Counter()
        for text in sentences:
            plain = _IN_BRACKETS.sub("", text)
            text = plain if _POINT.search(plain) else text
            text = _TO.sub(_expanded, _EXCEPT.sub("", text))
            said = self._named.sub(lambda name: f"#{self._ids[name[0].lower()]}", text)
            for part in re.split(r"(?<=\.)\s+(?=[A-Z])", said):
                spared = _SPARED.search(part) is not None
                found.update({(spared, int(number)) for number in _POINT.findall(part)})
                if _FREE.search(part):
                    found[(False, _ORDER)] = 1
                if _CASE.search(part):
                    found[(False, 0)] += 1
        return found


def _wrong_mission(mission: Mission, expected: dict[str, Any]) -> Iterable[str]:
    found = [int(task.object_id or 0) for task in mission.tasks if task.action == "MEASURE"]
    wanted, free = expected["checkpoints"], expected["any_order"]
    if not _same(found, wanted, free, expected["rounds"] != "one round"):
        yield f"measures {found}, not {wanted}"
    for name, value in (
        ("start_area", mission.start_area),
        ("max_duration_s", mission.max_duration),
    ):
        if expected[name] is not None and value != expected[name]:
            yield f"{name} is {value}, not {expected[name]}"
    partly = mission.order == "any" and bool(mission.before)  # free within a floor
    if free != (mission.order == "any") and not (partly and not free):
        yield f"the order is {mission.order}"


def _same(found: list[int], wanted: list[int], free: bool, rounds: bool) -> bool:
    """Return True if two lists of checkpoints are the same; rounds may be written out."""
    pairs = [(found, wanted)]
    if rounds:
        pairs.append((_once(found), _once(wanted)))
        pairs.append((found, wanted * (len(found) // max(len(wanted), 1))))
    if free:
        return any(Counter(a) == Counter(b) for a, b in pairs)
    return any(a == b for a, b in pairs)


def _once(ids: list[int]) -> list[int]:
    return [id for i, id in enumerate(ids) if i == 0 or id != ids[i - 1]]
