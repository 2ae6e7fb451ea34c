"""The deletion law: leave out a word or a line of a script, and something differs.

The mission, a message or whether there is a mission differs, unless the word

- stands in a place in which the language names it as without effect, or links others;
- is part of a phrase that the reference lists without it, with the same meaning;
- says again what is said elsewhere, or what is the default: then another word in its place makes
  a difference, so that it is read and has to agree. The same holds for a line of such words.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.il import Mission
from argo_compiler.script import LineState, import_script, parse
from argo_compiler.script.parsing.script import Script
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexer import all_words
from argo_compiler.script.sentences.words.lexicon import Lexicon
from argo_compiler.script.sentences.words.loading import table_of
from argo_compiler.script.sentences.words.without_effect import LINKING, left_out
from argo_compiler.script.sentences.words.word import Word
from tests.argo_compiler.script.importing_scripts import ImportingScript
from tests.mission_writing import unplaced

_TOKEN = re.compile(r"[☑✓✔✗☐%°]|[^\W_](?:[\w%°'./]*[^\W_])?")
_LINE = re.compile(r"\bline \d+")
_CONTRASTS: Sequence[tuple[str, ...]] = (
    ("AT_END", "AT_BEGIN", "INSTEAD", "THERE", "ORDINAL", "FIRST"),
    ("ALL", "EVERY", "BOTH", "EITHER", "NEITHER"),
    ("IF", "UNLESS", "UNTIL", "ELSE", "IN_ANY_CASE"),
    ("THIS_ORDER", "ANY_ORDER", "REVERSED"),
    ("GREATER", "LESS", "AT_LEAST", "AT_MOST", "MORE_WORD"),
    ("DOCK", "AREA", "FLOOR", "PLACE"),
    ("OCCURS", "FAILS", "STATE", "CHARGED"),
    ("STOPPING", "FINISHING"),
    ("WITHIN", "EARLIEST", "LATEST", "BEFORE", "AFTER", "SINCE_START", "TAKING"),
    ("TIMES", "MORE", "TOTAL"),
    ("IT", "HE", "THIS", "THEM", "VALUE", "OF", "KIND"),
    ("MEASURE", "SPARE", "WAIT", "HOME", "DELETE", "START"),
)
"""terminals whose words say different things in the same place"""
_ASIDES = frozenset(["script.no-effect", "script.comment", "script.set-aside"])
_VALUES = {
    "NUMBER": ("2", "3", "7", "19", "99"),
    "IDENT": ("R25", "R12", "R99"),
    "STRING": ('"other"',),
    "DURATION": ("7 minutes",),
    "WORD": ("pump",),
}
"""words that no lexicon has"""
_VERBS = frozenset([*table_of("english")["verbs"], "BACK"])


@dataclass(frozen=True)
class Deletion:
    """A word or a line whose deletion changes nothing, and which nothing shows to be read."""

    text: str
    terminal: str
    """of the word; empty for a line"""
    context: str


@dataclass(frozen=True)
class _Placed:
    """A word of the language, at its place in the script."""

    word: Word
    start: int
    end: int
    free: bool
    """whether it has no effect at its place"""


def _report(diagnostic: Diagnostic) -> tuple[str, str]:
    """Return the code and the message of a diagnostic without the numbers of lines; of a text that
    is reported to have no effect, and may be shortened in the message, with its length."""
    length = diagnostic.span.length if diagnostic.span and diagnostic.code in _ASIDES else ""
    return diagnostic.code, f"{_LINE.sub('line', diagnostic.message)} {length}"


class DeletionTrial:
    """Trial of all deletions in a script that imports."""

    def __init__(self, script: ImportingScript) -> None:
        self.script = script
        self.text = script.text
        self.outcome = self._outcome(script.text)

    @property
    def tokens(self) -> list[re.Match[str]]:
        """The words of the text, as a reader counts them."""
        start, end = self.script.within or (0, len(self.text))
        return list(_TOKEN.finditer(self.text, start, end))

    @property
    def lines(self) -> list[tuple[int, int]]:
        """The places of all lines but empty ones."""
        start, end = self.script.within or (0, len(self.text))
        found = (line.span() for line in re.finditer(r"[^\n]*(?:\n|$)", self.text))
        return [(a, b) for a, b in found if start < b and a < end and self.text[a:b].strip()]

    def swallowed_word(self, token: re.Match[str]) -> Deletion | None:
        """Return the deletion of a word if it breaks the law."""
        start, end = token.span()
        if not self._is_same(self._without(start, end)):
            return None
        word = self._words.get(start)
        if word is not None and (word.free or word.word.type in LINKING):
            return None
        if self._is_variant(start, end, word) or self._is_read(token):
            return None
        return Deletion(token[0], "" if word is None else word.word.type, self._context(start, end))

    def swallowed_line(self, start: int, end: int) -> Deletion | None:
        """Return the deletion of a line if it breaks the law."""
        if not self._is_same(self.text[:start] + self.text[end:]):
            return None
        tokens = list(_TOKEN.finditer(self.text, start, end))
        if not tokens or any(map(self._is_read, tokens)):
            return None
        return Deletion(self.text[start:end].strip(), "", self._context(start, end))

    def _is_same(self, text: str) -> bool:
        return self._outcome(text) == self.outcome

    def _outcome(self, text: str) -> tuple[Mission, list[tuple[str, str]]] | None:
        """Return the mission of a text and the messages; None if something is left to decide."""
        script = self.script
        try:
            draft = import_script(
                text, script.catalog, decisions=script.decisions, start_area=script.start_area
            )
        except DiagnosticError:
            return None
        if draft.mission is None:
            return None
        messages = sorted(map(_report, draft.diagnostics))
        aside = [("aside", line.text) for line in draft.lines if line.state is LineState.SET_ASIDE]
        return unplaced(draft.mission), messages + aside

    def _without(self, start: int, end: int) -> str:
        """Return the text without a word and a blank beside it."""
        if self.text[end : end + 1] == " ":
            end += 1
        elif self.text[start - 1 : start] == " ":
            start -= 1
        return self.text[:start] + self.text[end:]

    def _context(self, start: int, end: int) -> str:
        text = self.text
        found = f"{text[max(0, start - 50) : start]}[[{text[start:end]}]]{text[end : end + 40]}"
        return found.replace("\n", "/")

    # ---- words of the language

    @cached_property
    def _lexicon(self) -> Lexicon:
        return Language.of(self.text, [place.name for place in self.script.catalog.places]).lexicon

    @cached_property
    def _script(self) -> Script:
        catalog = self.script.catalog
        places = [place.name for place in catalog.places]
        names = [checkpoint.name for checkpoint in catalog.checkpoints]
        tags = {tag: (c.id, c.name) for c in catalog.checkpoints for tag in c.tags}
        return parse(self.text, places, "script", names, {}, tags)

    def _is_in_sheet(self, at: int) -> bool:
        """Return True in a row of a sheet, each cell of which is compared with the site: a word
        that no cell has makes the row one to confirm."""
        rows = self._script.rows.values()
        return any(row.place.first <= at <= row.place.last for row in rows)

    @cached_property
    def _words(self) -> dict[int, _Placed]:
        """The words of the language, by the place of each of their characters."""
        found: dict[int, _Placed] = {}
        for piece in self._script.pieces:
            offsets = piece.text.offsets
            words = self._read(piece.text.content)
            free = {word.start for word in left_out(words)}
            for word in words:
                start, end = offsets[word.start], offsets[word.end - 1] + 1
                placed = _Placed(word, start, end, word.start in free)
                found |= dict.fromkeys(range(start, end), placed)
        return found

    def _read(self, text: str) -> list[Word]:
        """Return the words of a sentence in the language that knows more of them."""
        lexicons = [self._lexicon, self._lexicon.other or self._lexicon]
        found = [all_words(text, lexicon) for lexicon in lexicons]
        return min(found, key=lambda words: sum(word.type == "WORD" for word in words))

    def _is_variant(self, start: int, end: int, placed: _Placed | None) -> bool:
        """Return True if the reference lists the phrase of a word without it as well, as in `is
        above` and `above`."""
        if placed is None or (placed.start, placed.end) == (start, end):
            return False
        phrase = self.text[placed.start : placed.end]
        rest = self._read(phrase[: start - placed.start] + phrase[end - placed.start :])
        return [(word.type, word.value) for word in rest if word.type not in LINKING] == [
            (placed.word.type, placed.word.value)
        ]

    # ---- other words in its place

    def _is_read(self, token: re.Match[str]) -> bool:
        """Return True if another word in the place of one makes a difference."""
        start, end = token.span()
        placed = self._words.get(start)
        if placed is not None and placed.word.type not in _VALUES:
            if placed.free or placed.word.type in LINKING:
                return False
            start, end = placed.start, placed.end
        others = self._others(placed, self.text[start:end])
        others += _VALUES["WORD"] if self._is_in_sheet(start) else ()
        return any(not self._is_same(self.text[:start] + o + self.text[end:]) for o in others)

    def _others(self, placed: _Placed | None, said: str) -> list[str]:
        """Return words that say something else where a word stands."""
        if placed is None or placed.word.type in _VALUES:
            type_ = "WORD" if placed is None else placed.word.type
            type_ = "NUMBER" if said.isdecimal() else type_
            return [other for other in _VALUES[type_] if other.lower() != said.lower()]
        word = placed.word
        phrases = self._phrases_of_terminal
        found = [texts[0] for value, texts in phrases.get(word.type, []) if value != word.value]
        types = next((types for types in _CONTRASTS if word.type in types), ())
        if word.type in _VERBS:
            types = _CONTRASTS[-1]
        for type_ in types:
            if type_ != word.type:
                found += [texts[0] for _, texts in phrases.get(type_, [])[:2]]
        return found[:12]

    @cached_property
    def _phrases_of_terminal(self) -> dict[str, list[tuple[object, list[str]]]]:
        found: dict[str, list[tuple[object, list[str]]]] = {}
        for (type_, value), texts in self._lexicon.phrases.items():
            found.setdefault(type_, []).append((value, texts))
        return found
