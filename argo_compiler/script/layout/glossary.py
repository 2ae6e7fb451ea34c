"""Short forms: plant tags and abbreviations, each replaced by what it stands for.

A site gives the tags of its checkpoints; a script explains its own: `PG = pressure gauge`, or lists
tags below a heading such as `Tags on this sheet`. A tag is written in any spacing, with or without
the number of its unit: `20-PI-1034A`, `PI 1034 A`, `PI_1034A`. A tag with two meanings is left.
"""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from argo_compiler.script.documents.source import Diagnostics, ScriptText, Source, join
from argo_compiler.script.documents.tags import TAGS, tag_from, tag_of
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.tree.nouns import Kind
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.prose import PhrasePattern, phrase_pattern

LEGEND = "a part of a legend or of a list of tags"
EXPLANATION = "an explanation of what a name stands for"
_SHORT = re.compile(r"[A-Z][A-Z/]{0,5}[0-9]?|[A-Z]{1,3}[a-z]{0,2}")
"""an abbreviation"""
_EQUATION = re.compile(r"\s*(?P<short>[\w-]+(?: [\w-]+)?)\s*(?:=|:=)\s*(?P<long>[^=]+?)\s*")
_LISTED = re.compile(
    r"\s*(?:[-*•]\s+)?(?P<short>[\w-]+(?: [\w-]+)?)(?:\s{2,}|\s*[\t|:;=]\s*)(?P<long>\S.*?)\s*"
)
_PARTED = re.compile(r"[=\t|:;]|\S\s{2,}\S|^\s+$")
"""a line without this explains nothing"""
_BETWEEN = re.compile(r"[,;|]\s*|\s{2,}|\t")
_LONGEST = 200
"""characters of a line that explains"""
_MOST_MEANINGS = 2000

Tags = Mapping[str, tuple[int, str]]
"""the number and name of a checkpoint, by its plant tag"""


@dataclass
class Glossary:
    """The meanings of short forms. Mutable: it grows by the lines that explain some."""

    understanding: Understanding
    names: Mapping[str, str] = field(default_factory=dict)
    """the names of checkpoints, by their numbers: `#4`"""
    meanings: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    """by a tag without its signs, or an abbreviation"""

    @cached_property
    def _abbreviations(self) -> re.Pattern[str]:
        said = sorted((s for s in self.meanings if not tag_of(s)), key=len, reverse=True)
        either = "|".join(map(re.escape, said)) or "(?!)"
        return re.compile(rf"(?<![\w-])({either})(?:(?![\w-])|(?<=[A-Za-z])[-_]?(?=[0-9]))")

    def add(self, short: str, meaning: str) -> None:
        """Add a short form; a tag with and without the number of its unit."""
        tag = tag_of(short)
        for said in {short} if tag is None else {tag.whole, tag.name}:
            self.meanings[said].add(meaning)

    def expanded(self, text: ScriptText) -> ScriptText:
        """Return a text with what its short forms stand for."""
        for found in reversed(list(TAGS.finditer(text.content))):
            tag = tag_from(found)
            meant = self.meanings.get(tag.whole) or ()
            if len(meant) == 1:
                (word,) = meant
                start = self._kind_before(text, found.start(), word)
                text = text if start is None else text.replace(start, found.end(), word)
        for found in reversed(list(self._abbreviations.finditer(text.content))):
            meant = self.meanings[found[1]]
            if len(meant) == 1:
                (word,) = meant
                blank = " " if text.content[found.end() : found.end() + 1].isdigit() else ""
                text = text.replace(found.start(), found.end(), word + blank)
        return text

    def _kind_before(self, text: ScriptText, start: int, meaning: str) -> int | None:
        """Return where the kind begins that stands before a tag and says the same as it: `valve
        HV-025`; None if it says something else."""
        before = self.understanding.words(text[:start])[-1:]
        if not before or before[0].type != "KIND" or text.content[before[0].end : start].strip():
            return start
        kind = before[0].value[0]
        name = self.names.get(meaning, meaning)
        own = {
            w.value[0] for w in self.understanding.words(text.replaced(name)) if w.type == "KIND"
        }
        gauges = {Kind.PRESSURE_GAUGE, Kind.LIQUID_LEVEL_GAUGE}
        alike = kind is Kind.CHECKPOINT or kind in own or (kind is Kind.GAUGE and own & gauges)
        return before[0].start if alike else None


@dataclass(frozen=True)
class Explained:
    """A script whose short forms are replaced."""

    source: Source
    explanations: tuple[tuple[ScriptText, str], ...] = ()
    """the lines that only say what short forms stand for; those of a legend that do not, with the
    reason why they have no effect"""


def explain(
    source: Source, understanding: Understanding, tags: Tags, diagnostics: Diagnostics
) -> Explained:
    """Return the script with what its short forms stand for in their place; `tags` are those of the
    site."""
    names = {f"#{number}": name for number, name in tags.values()}
    glossary = Glossary(understanding, names)
    for tag, (number, _) in tags.items():
        glossary.add(tag, f"#{number}")
    idle: set[int] = set()
    lines = dict(_lines(source, glossary, idle))
    if not glossary.meanings and not lines:
        return Explained(source)
    explanations = {n: text for n, text in lines.items() if text is not None}
    for number, text in explanations.items():
        if number in idle:
            message = f"`{text.content}` is set aside: it is {LEGEND}"
            diagnostics.warning("set-aside", message, text.span())
            continue
        message = f"`{text.content}` has no effect by itself: it is {EXPLANATION}"
        diagnostics.note("no-effect", message, text.span())
    expanded = {number: text[:0] for number, text in explanations.items()}
    for number in range(1, len(source.lines) + 1):
        line = source.line_text(number)
        if number not in lines and (text := glossary.expanded(line)) is not line:
            expanded[number] = text
    pieces = ((text, LEGEND if n in idle else "") for n, text in explanations.items())
    return Explained(replace(source, expanded=expanded), tuple(pieces))


def _lines(
    source: Source, glossary: Glossary, idle: set[int]
) -> Iterator[tuple[int, ScriptText | None]]:
    """Yield the lines in which short forms stand beside what they mean, and add that to the
    glossary; None for one that may be a task as well: `HV-025  valve R25` without a heading.

    The numbers of other lines of a legend are added to `idle`."""
    headed = False
    heading: tuple[int, ScriptText] | None = None
    is_heading = phrase_pattern(glossary.understanding.language.prose.form["glossary"])
    explaining = _explaining_lines(source, is_heading)
    last = 0
    for number in source.unclear:
        line = source.lines[number - 1]
        if number > last + 1:
            headed, heading = False, None
        last = number
        if number in explaining:
            text = source.line_text(number).strip()
            meanings = _explained_in_row(text, source, number, glossary)
            for short, long in meanings:
                glossary.add(short, long)
            if text.content:
                idle |= set() if meanings else {number}
                yield number, text
            continue
        if line and _PARTED.search(line) is None and not is_heading.match(line.lstrip()):
            headed, heading = False, None
            continue
        text = source.line_text(number).strip()
        if not text.content or len(line) > _LONGEST or len(glossary.meanings) > _MOST_MEANINGS:
            headed = headed and not text.content and not source.lines[number - 2].strip(" =-:")
            continue
        if is_heading.fullmatch(text.content.rstrip(" :")):
            headed, heading = True, (number, text)
            continue
        found = _equations(text, glossary)
        listed = _LISTED.fullmatch(text.content) if not found else None
        named = [] if listed is None else _meant(listed, text, glossary)
        explains = bool(found) or (headed and bool(named))
        headed = headed and explains
        if named and not explains and tag_of(named[0][0]) is None:
            continue
        for short, long in found or named:
            glossary.add(short, long)
        if heading is not None and explains:
            yield heading
        heading = None
        if found or named:
            yield number, text if explains else None


def _explaining_lines(source: Source, heading: PhrasePattern) -> frozenset[int]:
    """Return the numbers of the lines of a document that only explain: those of a sheet whose name
    or first line is such as `Legend`, and those of a table below such a heading."""
    document = source.document
    if document is None:
        return frozenset()

    def heads(text: str) -> bool:
        return heading.fullmatch(text.strip(" :")) is not None

    sheets = {part for part, name in enumerate(document.parts) if heads(name)}
    tables: set[int] = set()
    found: set[int] = set()
    headed = False
    begun: set[int] = set()
    for number, line in enumerate(document.lines, start=1):
        if not line.text.strip():
            continue
        if document.parts and line.place and line.part not in begun and line.table is None:
            if heads(line.text):
                sheets.add(line.part)
            begun |= {line.part} if line.text.strip(" :") not in document.parts else set()
        if line.table is None:
            headed = heads(line.text)
            found |= {number} if headed else set()
        elif headed:
            tables.add(line.table)
            headed = False
        if (line.part in sheets and document.parts) or line.table in tables:
            found.add(number)
    return frozenset(found)


def _explained_in_row(
    text: ScriptText, source: Source, number: int, glossary: Glossary
) -> list[tuple[str, str]]:
    """Return what a row of a table explains: `PG | pressure gauge`, or a tag beside the number and
    the name of a checkpoint."""
    origin = source.origin(number)
    if origin is None or origin.table is None:
        return []
    cells = [cell.strip() for cell in _cells_of(text)]
    cells = [cell for cell in cells if cell.content]
    if len(cells) == 2:
        listed = _LISTED.fullmatch(f"{cells[0].content} | {cells[1].content}")
        whole = join(cells, " | ")
        return [] if listed is None else _meant(listed, whole, glossary)
    tags = [cell for cell in cells if tag_of(cell.content) is not None]
    others = [cell for cell in cells if cell not in tags]
    names = [cell.content for cell in others if _names_checkpoint(cell, glossary)]
    numbers = [cell.content for cell in others if cell.content.isdecimal()]
    if len(tags) != 1 or len(names) > 1 or not (names or numbers):
        return []
    meaning = " ".join([*names, *([f"(#{numbers[0]})"] if names and numbers else [])])
    return [(tags[0].content, meaning or f"#{numbers[0]}")]


def _cells_of(text: ScriptText) -> Iterator[ScriptText]:
    start = 0
    for bar in re.finditer(r"\|", text.content):
        yield text[start : bar.start()]
        start = bar.end()
    yield text[start:]


def _names_checkpoint(text: ScriptText, glossary: Glossary) -> bool:
    """Return True if a text names one checkpoint by its kind and its own name."""
    types = glossary.understanding.types(text)
    return types[:1] == ("KIND",) and {*types[1:]} in ({"NUMBER"}, {"IDENT"})


def _equations(text: ScriptText, glossary: Glossary) -> list[tuple[str, str]]:
    """Return the short forms with their meanings if a line has nothing but equations."""
    if "=" not in text.content:
        return []
    phrases = glossary.understanding.language.prose.form["glossary"]
    head = phrase_pattern(phrases).match(text.content)
    if head is not None:  # `Abbr.: PG = pressure gauge`
        text = text[head.end() :].strip()
        text = text[len(text.content) - len(text.content.lstrip(" .:")) :]
    found: list[tuple[str, str]] = []
    start = 0
    for between in [*_BETWEEN.finditer(text.content), None]:
        part = text[start : between.start() if between else len(text.content)].strip()
        start = between.end() if between else start
        equation = _EQUATION.fullmatch(part.content.rstrip(" ."))
        meant = _meant(equation, part, glossary) if equation else []
        if not meant:
            return []
        found += meant
    return found


def _meant(found: re.Match[str], text: ScriptText, glossary: Glossary) -> list[tuple[str, str]]:
    """Return a short form with its meaning: a kind, a checkpoint or a place; none if it is no short
    form, or if it can't stand for that."""
    short = found["short"].strip()
    abbreviated = _SHORT.fullmatch(short) is not None
    if not abbreviated and tag_of(short) is None:
        return []
    long = text[found.start("long") : found.end("long")]
    understanding = glossary.understanding
    types = understanding.types(long)
    if not types or "WORD" in types or short.lower() in understanding.names:
        return []
    named = bool({*types} & {"NUMBER", "IDENT", "STRING"})
    if not abbreviated and not named:
        return []
    starts = ("nouns", "location") if named or "KIND" not in types else ("nouns",)
    if all(isinstance(understanding.read(long, start), StumbleError) for start in starts):
        return []
    return [(short, long.content)]
