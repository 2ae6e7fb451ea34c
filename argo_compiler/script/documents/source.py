"""Text that remembers where it came from, and the diagnostics about it."""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import NoReturn, TypeVar
from unicodedata import normalize

from argo_compiler.base.errors import Remedy, RemedyChoice
from argo_compiler.diagnostics import MAX_EXCERPT, Diagnostic, Severity, Span, span_at
from argo_compiler.script.documents.document import Document, DocumentLine

MAX_LINE = 2000
"""characters in a line; a longer one is refused unread"""

_BEGINNING = 80
_LONGEST_SHOWN = 60
"""characters of a text that a message shows"""
MOST_KEPT = 2_000
"""errors; further ones are counted, but not kept"""
_LINE_END = re.compile(r"\r\n|\r|\n")
_NUMBERED = re.compile(
    r"[0-9]{1,6}\.(?: (?:[A-Za-z0-9#%()\"'+/-]|\.(?!\.)|[,:](?= ))+)+(?<=[a-z0-9)]\.)"
)
"""a step in plain signs: a sentence with its full stop, and one blank between two words of it"""
_LONGEST_NUMBERED = 200
_Item = TypeVar("_Item")
_Found = TypeVar("_Found")


class RefusedError(Exception):
    """Something that a script asks for is given up; an error among the diagnostics says why."""


@dataclass(frozen=True)
class Source:
    """A script as it was written. A byte order mark is not counted, as no editor shows it."""

    text: str
    name: str = "script"
    document: Document | None = None
    """the document that the text is of; None: it is the text of a file"""

    expanded: "Mapping[int, ScriptText]" = field(default_factory=dict, compare=False)
    """lines in which short forms are replaced by what they stand for, by their numbers"""
    decided: Mapping[int, Sequence[str]] = field(default_factory=dict, compare=False)
    """sentences that a person has decided on for pieces, by the offsets at which these begin"""

    @classmethod
    def of(cls, script: str | Document, name: str) -> "Source":
        """Return the source of a script that is a text or a document."""
        if isinstance(script, Document):
            return cls(script.text, name, script)
        return cls(normalize("NFC", script), name)

    def origin(self, number: int) -> DocumentLine | None:
        """Return where a line of a document is from; None in a text."""
        return None if self.document is None else self.document.line(number)

    def placed(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """Return diagnostics with their places in the document, if the script is one."""
        found = tuple(diagnostics)
        return found if self.document is None else self.document.placed(found)

    @cached_property
    def lines(self) -> tuple[str, ...]:
        return tuple(self.text[start:end] for start, end in self._bounds)

    @cached_property
    def _bounds(self) -> list[tuple[int, int]]:
        start = 1 if self.text.startswith("\ufeff") else 0
        bounds = []
        if "\r" not in self.text:  # the usual case, and splitting is faster than matching
            for line in self.text[start:].split("\n"):
                bounds.append((start, start + len(line)))
                start += len(line) + 1
            return bounds
        for match in _LINE_END.finditer(self.text):
            bounds.append((start, match.start()))
            start = match.end()
        bounds.append((start, len(self.text)))
        return bounds

    @cached_property
    def _starts(self) -> list[int]:
        return [start for start, _ in self._bounds]

    def said(self, first: Span, last: Span | None = None) -> str:
        """Return the words from the beginning of one span to the end of the other in the same line;
        of a piece that a person has decided on, its sentences."""
        decided = self.decided.get(self._starts[first.line - 1] + first.column - 1)
        if decided:
            return " ".join(decided).rstrip(".")
        end = last if last is not None and last.line == first.line else first
        return self.lines[first.line - 1][first.column - 1 : end.column - 1 + end.length]

    @cached_property
    def unclear(self) -> tuple[int, ...]:
        """The numbers of the lines that may be more than a sentence behind a step's number: that
        may have columns, a field or a blank to fill in, or begin another kind of line."""
        return tuple(
            number
            for number, line in enumerate(self.lines, start=1)
            if self.document is not None
            or number in self.expanded
            or len(line) > _LONGEST_NUMBERED
            or not _NUMBERED.fullmatch(line)
        )

    def line_text(self, number: int) -> "ScriptText":
        """Line `number`, counted from 1, without its end, and with its short forms replaced."""
        if number in self.expanded:
            return self.expanded[number]
        start, end = self._bounds[number - 1]
        return ScriptText(self.text[start:end], range(start, end), self)

    def line_at(self, offset: int) -> int:
        """The number of the line in which a character stands, from 1."""
        return bisect_right(self._starts, offset) or 1

    def offset_at(self, line: int, column: int) -> int:
        """The offset of a character by its line and column, from 1."""
        return self._starts[line - 1] + column - 1

    def span(self, start: int, end: int) -> Span:
        """The span of the characters `start` to `end`, cut at the end of its first line."""
        line = self.line_at(start)
        line_start, line_end = self._bounds[line - 1]
        length = (end if end < line_end else line_end) - start
        return span_at(line, start - line_start + 1, length if length > 1 else 1)


@dataclass(slots=True, unsafe_hash=True)
class ScriptText:
    """A piece of a script, perhaps healed: each character knows its offset in the source. Not
    frozen, as very many are made, and a frozen one takes longer to make; nothing changes one."""

    content: str
    offsets: Sequence[int]
    source: Source

    def __getitem__(self, part: slice) -> "ScriptText":
        return ScriptText(self.content[part], self.offsets[part], self.source)

    @property
    def first(self) -> int:
        """The least of the offsets in the source; -1 for an empty text."""
        offsets = self.offsets
        return -1 if not offsets else offsets[0] if type(offsets) is range else min(offsets)

    @property
    def last(self) -> int:
        """The greatest of the offsets in the source; -1 for an empty text."""
        offsets = self.offsets
        return -1 if not offsets else offsets[-1] if type(offsets) is range else max(offsets)

    @property
    def original(self) -> str:
        """The text as it stands in the source, if it is a part of one line of it."""
        part = self.source.text[self.first : self.last + 1]
        whole = "\n" not in part and all(a <= b for a, b in pairwise(self.offsets))
        return part if whole else self.content

    @property
    def is_question(self) -> bool:
        """Return True if a question mark stands at the end or behind it."""
        return self.source.text[self.last : self.last + 2].rstrip()[-1:] == "?"

    def replaced(self, content: str) -> "ScriptText":
        """Return another text that stands for this one, all of it at the place of this one."""
        first, last = self.first, self.last
        return ScriptText(content, [*[first] * (len(content) - 1), last], self.source)

    def strip(self) -> "ScriptText":
        content = self.content
        if content and not content[0].isspace() and not content[-1].isspace():
            return self
        left = len(content) - len(content.lstrip())
        return self[left : max(left, len(self.content.rstrip()))]

    def replace(self, start: int, end: int, word: str) -> "ScriptText":
        """The text with `word`, not empty, in place of the characters `start` to `end`."""
        old = self.offsets[start:end]
        new = [old[min(i, len(old) - 1)] for i in range(len(word))]
        new[-1] = old[-1]
        content = self.content[:start] + word + self.content[end:]
        return ScriptText(content, [*self.offsets[:start], *new, *self.offsets[end:]], self.source)

    def without(self, start: int, end: int) -> "ScriptText":
        """The text without the characters `start` to `end`."""
        offsets = [*self.offsets[:start], *self.offsets[end:]]
        return ScriptText(self.content[:start] + self.content[end:], offsets, self.source)

    def span(self, start: int = 0, end: int | None = None) -> Span:
        """Where the characters `start` to `end` stand; if there are none, the end of the text."""
        offsets = self.offsets
        last = len(offsets)
        if end is not None and end < last:
            last = end
        if start < last:
            return self.source.span(offsets[start], offsets[last - 1] + 1)
        after = self.offsets[-1] + 1 if self.offsets else 0
        return self.source.span(after, after + 1)


def shortened(text: str) -> str:
    """Return a text as a message shows it: the beginning of a long one."""
    return text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 3]}..."


def quotes(content: str) -> list[tuple[int, int]]:
    """Where quoted texts begin and end."""
    if '"' not in content:
        return []
    return [m.span() for m in re.finditer(r'"(?:[^"\\]|\\.)*"', content)]


def join(parts: Sequence[ScriptText], between: str = " ") -> ScriptText:
    """The texts, at least one, with a blank or other signs between each two."""
    content: list[str] = []
    offsets: list[int] = []
    for part in parts:
        if content and part.content:
            content.append(between)
            offsets.extend([part.offsets[0]] * len(between))
        content.append(part.content)
        offsets.extend(part.offsets)
    return ScriptText("".join(content), offsets, parts[0].source)


@dataclass
class Diagnostics:
    """Collects diagnostics; the one mutable thing that the stages hand on."""

    source: Source
    entries: list[Diagnostic] = field(default_factory=list)

    errors: int = field(init=False, default=0)
    """how many of the diagnostics are errors"""

    def __post_init__(self) -> None:
        self.errors = sum(d.severity is Severity.ERROR for d in self.entries)

    def error(
        self,
        code: str,
        message: str,
        span: Span | None,
        hint: str | None = None,
        remedy: Remedy | RemedyChoice | None = None,
    ) -> None:
        self._add(Severity.ERROR, code, message, span, hint, remedy)

    def refuse(
        self,
        code: str,
        message: str,
        span: Span | None,
        hint: str | None = None,
        remedy: Remedy | RemedyChoice | None = None,
    ) -> NoReturn:
        """Adds an error, and gives up what it is about. Raises RefusedError."""
        self.error(code, message, span, hint, remedy)
        raise RefusedError

    def each(self, find: Callable[[_Item], _Found], items: Iterable[_Item]) -> list[_Found]:
        """What is found for each; if something is refused, only after all have been looked at."""
        found: list[_Found] = []
        refused = False
        for item in items:
            try:
                found.append(find(item))
            except RefusedError:
                refused = True
        if refused:
            raise RefusedError
        return found

    def warning(self, code: str, message: str, span: Span | None, hint: str | None = None) -> None:
        self._add(Severity.WARNING, code, message, span, hint)

    def note(self, code: str, message: str, span: Span | None) -> None:
        self._add(Severity.NOTE, code, message, span, None)

    def _add(
        self,
        severity: Severity,
        code: str,
        message: str,
        span: Span | None,
        hint: str | None,
        remedy: Remedy | RemedyChoice | None = None,
    ) -> None:
        if severity is Severity.ERROR:
            self.errors += 1
            if self.errors > MOST_KEPT:
                return
        choice = remedy if isinstance(remedy, RemedyChoice) else None
        kind = remedy.remedy if isinstance(remedy, RemedyChoice) else remedy
        excerpt = _excerpt(self.source.lines[span.line - 1], span) if span else None
        self.entries.append(
            Diagnostic(
                code=f"script.{code}",
                severity=severity,
                message=message,
                span=span,
                excerpt=excerpt,
                hint=hint,
                remedies=() if kind is None else (kind,),
                choice=choice,
            )
        )

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Adds what another stage has found."""
        found = tuple(diagnostics)
        self.entries += found
        self.errors += sum(d.severity is Severity.ERROR for d in found)

    def by_place(self) -> tuple[Diagnostic, ...]:
        """All diagnostics in the source's order, those without a place last."""
        return tuple(sorted(self.entries, key=_place))


def _place(diagnostic: Diagnostic) -> tuple[bool, int, int]:
    span = diagnostic.span
    return (span is None, span.line if span else 0, span.column if span else 0)


def _excerpt(line: str, span: Span) -> str:
    """What is shown of a line: of a long one the beginning, if the mark is there."""
    marked = span.column + span.length <= _BEGINNING
    if len(line) > MAX_LINE or (len(line) > MAX_EXCERPT and marked):
        line = f"{line[:_BEGINNING]} ..."
    return _shown(line)


@lru_cache(maxsize=64)
def _shown(line: str) -> str:
    """Return a line without control characters, which would reach the user's terminal."""
    if line.replace("\t", " ").isprintable():
        return line
    return "".join(c if c.isprintable() or c == "\t" else " " for c in line)
