"""The cells of a mission sheet: its labels stand beside the middle of their cells.

The first lines of a cell may come before the label, and a label of two words may stand in two
lines: `Anomaly` and below it `specification:`. A line without a label belongs to the label above,
unless it begins a sentence that goes on beside the label below: it opens with a capital, the lines
down to the label do not end the sentence, and the text beside the label does not open one.
"""

import re
from collections.abc import Iterable, Sequence
from itertools import islice

from argo_compiler.base.records import dataclass
from argo_compiler.script.documents.source import ScriptText, join
from argo_compiler.script.layout.fields import ScriptFields
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.loading import pattern

_WORD = re.compile(r"[\w'-]+(?!\s*:)\b")
_MOST_WORDS = 3
"""of the first half of a label"""
_WORD_COLON = re.compile(r"[\w'-]+\s*:")
_MARKED = r"\s*(?:[-*+•#]\s|(?:<step>\s+)?[0-9]{1,6}\s*[.):])"
"""the mark of a line that is a step"""
_SENTENCE_ENDS = (".", "!", "?", ":")


@dataclass
class _Cell:
    """The label of a field, and its text while that is gathered."""

    at: int
    """the line, from 0"""
    label: ScriptText
    parts: list[ScriptText]


class Cells:
    """Puts the lines of a cell into one."""

    def __init__(self, fields: ScriptFields, understanding: Understanding) -> None:
        self.fields = fields
        self.understanding = understanding
        self.label = fields.prose.label

    def joined(self, lines: Sequence[ScriptText], unclear: Iterable[int]) -> list[ScriptText]:
        """The lines, those of a cell in the line of its label, their own lines empty. `unclear` are
        the numbers of all lines that may be no numbered sentences."""
        found = list(lines)
        near = sorted({i for n in unclear for i in (n - 2, n - 1)} - {-1})
        cells = [
            i
            for i, line in zip(near, map(lines.__getitem__, near), strict=True)
            if self.fields.is_cell(line.strip()) or self._halves(lines, i) is not None
        ]
        above: _Cell | None = None
        waiting: list[int] = []
        first, last = (max(0, cells[0] - 4), cells[-1] + 4) if cells else (0, 0)
        for i in range(first, min(last, len(lines))):
            text = found[i].strip()
            if not text.content:
                continue
            text = self._whole_label(found, i) or text
            below = self._cell(i, text) if self.fields.is_cell(text) else None
            if below is None and self._is_loose(found, i, above):
                waiting.append(i)
                continue
            self._place(waiting, above, below, found)
            above, waiting = below, []
        self._place(waiting, above, None, found)
        return found

    def _cell(self, at: int, text: ScriptText) -> _Cell:
        label = self.label.match(text.content)
        assert label is not None
        value = text[label.end() :].strip()
        return _Cell(at, text[: label.end()], [value] if value.content else [])

    def _whole_label(self, lines: list[ScriptText], i: int) -> ScriptText | None:
        """The line with the whole of a label that goes on in the next one, which keeps what else
        stands in it."""
        parts = self._halves(lines, i)
        if parts is None:
            return None
        label, beside, rest = parts
        lines[i] = join(
            [label, beside] if self.label.match(rest.content) else [label, beside, rest]
        )
        lines[i + 1] = rest if self.label.match(rest.content) else rest[:0]
        return lines[i]

    def _halves(
        self, lines: Sequence[ScriptText], i: int
    ) -> tuple[ScriptText, ScriptText, ScriptText] | None:
        """A label in two lines, and what stands beside its first and its second word."""
        if i + 1 >= len(lines):
            return None
        first, second = lines[i].strip(), lines[i + 1].strip()
        behind = _WORD_COLON.match(second.content)
        if behind is None or self.label.match(second.content):
            return None
        for words in islice(_WORD.finditer(first.content), _MOST_WORDS):
            label = join([first[: words.end()], second[: behind.end()]])
            if ":" not in label.content[:-1] and self.fields.is_cell(label):
                return label, first[words.end() :].strip(), second[behind.end() :].strip()
        return None

    def _is_loose(self, lines: Sequence[ScriptText], i: int, above: _Cell | None) -> bool:
        """Whether a line may belong to a cell: it has neither label nor mark, and makes no sense by
        itself."""
        line, text = lines[i], lines[i].strip()
        if pattern(_MARKED).match(line.content) or self.fields.is_field(text):
            return False
        if line.content[0] == "\t" and self._before_cell(lines, i):
            return True
        if self.understanding.fits(text):
            return False
        if line.content[0].isspace():
            return above is not None or self._before_cell(lines, i)
        ends = text.content.endswith(_SENTENCE_ENDS) or ":" in text.content
        opens = above is not None and text.content[0].isupper() and not ends
        return opens and self._before_cell(lines, i, 1)

    def _before_cell(self, lines: Sequence[ScriptText], i: int, most: int = 3) -> bool:
        """Whether the next line that has a label, a few lines on, is a cell's."""
        for k in range(i + 1, min(i + 1 + most, len(lines))):
            text = lines[k].strip()
            if not text.content or pattern(_MARKED).match(text.content):
                return False
            if self.fields.is_cell(text) or self._halves(lines, k) is not None:
                return True
        return False

    def _place(
        self, waiting: list[int], above: _Cell | None, below: _Cell | None, found: list[ScriptText]
    ) -> None:
        """Gives the waiting lines to the cell above and the cell below."""
        split = _first_of_below([found[i].strip() for i in waiting], below)
        if above is not None:
            self._write(above, [*above.parts, *(found[i].strip() for i in waiting[:split])], found)
        if below is not None and waiting[split:]:
            below.parts[:0] = [found[i].strip() for i in waiting[split:]]
            self._write(below, below.parts, found)
        for i in waiting if above is not None else waiting[split:]:
            found[i] = found[i][:0]

    def _write(self, cell: _Cell, parts: list[ScriptText], found: list[ScriptText]) -> None:
        cell.parts = parts
        found[cell.at] = join([cell.label, *parts])


def _first_of_below(lines: Sequence[ScriptText], below: _Cell | None) -> int:
    """The index of the first of the lines that belongs to the cell below them."""
    if not lines or below is None or lines[-1].content.endswith(_SENTENCE_ENDS):
        return len(lines)
    if below.parts and below.parts[0].content[0].isupper():
        return len(lines)
    openings = [i for i, line in enumerate(lines) if line.content[0].isupper()]
    return openings[-1] if openings else len(lines)
