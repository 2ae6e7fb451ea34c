"""Which lines of a script belong together: as one text, or one within another.

A line that is not finished goes on in the next one. Whether it is finished is told by what it says:
where its last sentence and the line below make sense as one, they are one.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import field

from argo_compiler.base.records import dataclass
from argo_compiler.script.documents.source import ScriptText, join
from argo_compiler.script.layout.asides import Asides
from argo_compiler.script.layout.fields import ScriptFields
from argo_compiler.script.layout.forms import ROW
from argo_compiler.script.layout.lines import LineMark, ScriptLine, sentence_bounds, sentences
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.tree.places import FloorName
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.without_effect import MISPLACED
from argo_compiler.script.sentences.words.word import VERBS


@dataclass(slots=True)
class LineItem:
    """A step, a bullet or a paragraph: its text, and what lies within it."""

    text: ScriptText
    line: ScriptLine
    items: "list[LineItem]" = field(default_factory=list)
    parts: list[ScriptText] = field(default_factory=list)
    """the lines of the text, while they are gathered"""
    tail: ScriptText | None = None
    """the last sentence of the parts; of a long one its end"""
    long: bool = False
    """whether the last sentence is so long that only its end tells whether it goes on"""
    over: bool = False
    """whether its last line stands over one with a mark"""
    floors: Sequence[FloorName] = ()
    """where what it names is, as the heading over it says"""
    own: ScriptText | None = None
    """its text as it stands in its lines, where `text` has words of the line over the list too"""

    def __post_init__(self) -> None:
        self.over = self.line.heading

    @property
    def last_line(self) -> str:
        """The last of its lines."""
        return (self.parts[-1] if self.parts else self.text).content

    @property
    def last(self) -> ScriptText:
        """The last sentence."""
        if self.tail is None:
            self.tail = _last_sentence(self.text)
        return self.tail

    def finish(self) -> "LineItem":
        """The item with its lines in one text."""
        if self.parts:
            self.text = join([self.text, *self.parts])
            self.parts = []
        for item in self.items:
            item.finish()
        return self


_OPENERS = frozenset([*VERBS, "IF", "UNLESS", "ELSE"]) - {"DOCK", "FROM"}
_OPENING_TYPES = frozenset((type_,) for type_ in _OPENERS)
_WORD = re.compile(r"\w+")
_LAST = 80
"""characters at the end of a text that tell whether it goes on"""
_LONGEST_MENDED = 300
"""characters of a sentence that is mended to see whether it makes sense"""
_TEXT = r'"(?:[^"\\]|\\.)*"\s*'
_TEXTS = re.compile(f"(?:{_TEXT})+")
_NAMED_STEP = re.compile(f"{_TEXT}:")
"""`"Alpha": check ...`"""
_LONGEST_SENTENCE = 2000
"""characters; no line goes on with a longer one"""
_END = 200
"""characters at the end of a longer one that are looked at"""
_MOST_KNOWN = 1024
_WRAPPED = 45
"""characters; no shorter line is broken for its length"""
_LONGEST_STRANGE = 300
"""characters; lines that make no sense are put together up to here"""
_DEEPEST = 20
"""items that are nested; what lies deeper is taken to lie there"""
_LAST_HALF = re.compile(r"([^\W\d_]+)-$")
_SEPARATOR = re.compile(r"([-=_*~])\1{2,}.+\1{3,}$")
"""`-----Original Message-----`"""
_FIRST_HALF = re.compile(r"[^\W\d_]+")


@dataclass(frozen=True)
class LineSense:
    """Tells what lines make sense, and how."""

    understanding: Understanding
    asides: Asides
    fields: ScriptFields
    width: int
    """characters of the longest line"""
    one: dict[tuple[object, ...], bool] = field(default_factory=dict)
    """whether two lines, one below the other, are one text; many are alike"""

    def stands_alone(self, text: ScriptText) -> bool:
        """Whether a line never goes on with the one above it."""
        content = text.content
        if ROW in content:
            return True
        asides = self.asides
        numbered = content[-1:].isdigit() and asides.is_explicit_title(text)
        apart = _SEPARATOR.match(content) is not None or asides.retracts(content)
        alone = numbered or apart or asides.is_remark(content) or asides.opens(content)
        bare = text[: len(content.rstrip(" .!"))]
        limit = self.understanding.types(bare) == ("MOST_TIME",)  # of the mission, not of a task
        return alone or limit or self.fields.is_field(text)

    def counts(self, above: ScriptText, below: ScriptText) -> bool:
        """Return True if a number at the end of a line would count the checkpoints of a kind which
        stands alone in the next one: `1, 4` over `Level gauges`."""
        bare = below[: len(below.content.rstrip(" .:"))]
        kinds = {"KIND"} >= {*self.understanding.types(bare)}
        return kinds and above.content[-1:].isdigit() and below.content[0].isupper()

    def is_broken(self, line: str, below: ScriptText) -> bool:
        """Return True if a line was broken for its length and goes on in the next one."""
        first = below.content.split(maxsplit=1)[0]
        full = len(line) >= _WRAPPED and len(line) + 1 + len(first) > self.width
        types = self.understanding.types(below)
        return full and below.content[0].islower() and types[:1] not in _OPENING_TYPES

    def announces(self, text: ScriptText) -> bool:
        """Whether a text says that lines below it are to be done: `Do the following twice:`."""
        listed = text.content.endswith(":")
        types = {*self.understanding.types(text)} if listed else set()
        return "DO_FOLLOWING" in types and not types & {"MEASURE", "KIND"}

    def is_complete(self, text: ScriptText) -> bool:
        """Whether a text makes sense by itself."""
        if self.fields.is_field(text):
            return True
        return all(self._fits(sentence) for sentence in sentences(text))

    def is_unfinished(self, text: ScriptText) -> bool:
        """Whether a text plainly goes on: after a comma, `and` or `, then`."""
        text = text[-_LAST:]
        if text.content.endswith((",", '":')) or self.understanding.unfinished(text) is not None:
            return True
        found = self.understanding.words(text)
        behind = text[found[-1].end :] if found else text[:0]
        return "," in behind.content or any(
            self.understanding.unfinished(behind[: word.end()]) is not None
            for word in _WORD.finditer(behind.content)
        )

    def opens_sentence(self, text: ScriptText) -> bool:
        """Whether a text begins as a sentence of its own does."""
        types = self.understanding.types(text)
        opens = bool(types) and types[0] in _OPENERS
        return opens and (text.content[0].isupper() or self.is_complete(text))

    def begins_with_joint(self, text: ScriptText) -> bool:
        """Whether a text begins with `and` or the like."""
        found = self.understanding.words(text)
        first = found[0] if found else None
        return first is not None and (
            first.type[:3] == "OR_" or any(map(str.isalpha, first.before))
        )

    def is_fragment(self, text: ScriptText, indented: bool) -> bool:
        """Whether a text that makes no sense by itself is no heading or remark, either."""
        beginning = indented or not text.content[0].isupper()
        ended = text.content.endswith(":") or self.asides.is_small_talk(text)
        return beginning and not ended

    def is_beginning(self, text: ScriptText, ended: bool) -> bool:
        """Whether a text is how a sentence begins; the whole of one where it has ended."""
        if self.understanding.has_strange_sign(text):
            return False
        if ended:
            return not isinstance(self.understanding.read(text), StumbleError)
        types = self.understanding.types(text)
        types = types[:-1] if types[-1:] == (MISPLACED,) else types  # an article, without its noun
        return "WORD" not in types and self.understanding.grammar.begins(types)

    def _fits(self, sentence: ScriptText) -> bool:
        understanding = self.understanding
        if understanding.has_strange_sign(sentence):
            return False
        return understanding.fits(sentence) or (
            len(sentence.content) <= _LONGEST_MENDED
            and "WORD" in understanding.types(sentence)
            and understanding.respelled(sentence, quiet=True) is not None
        )


def items_of(
    lines: Iterable[ScriptLine], sense: LineSense, words: Collection[str]
) -> Iterator[LineItem]:
    """The steps and paragraphs, those that lie within others inside of them. By `words` it is told
    whether a hyphen at the end of a line divides a word."""
    around: list[LineItem] = []
    for line in lines:
        if around and not line.first and _goes_on(around[-1], line, sense):
            _append(around[-1], line.unmarked, words)
            around[-1].over = line.heading
            continue
        item = LineItem(line.text, line)
        while around and not (
            _lies_in(line, around[-1].line) or _is_listed(line, around[-1], sense)
        ):
            outer = around.pop()
            if not around:
                yield outer.finish()
        if around:
            around[-1].items.append(item)
        if len(around) < _DEEPEST:
            around.append(item)
    if around:
        yield around[0].finish()


def _append(item: LineItem, below: ScriptText, words: Collection[str]) -> None:
    """Lets an item go on with a line; a word that a hyphen divides becomes whole."""
    last = item.last
    left = _LAST_HALF.search(last.content) if last.content.endswith("-") else None
    right = _FIRST_HALF.match(below.content)
    if left is not None and right is not None and (left[1] + right[0]).lower() in words:
        cut = item.parts.pop() if item.parts else None
        whole = _without_hyphen(cut or item.text, below)
        if cut is None:
            item.text = whole
        else:
            item.parts.append(whole)
        both = _without_hyphen(last, below)
    else:
        item.parts.append(below)
        both = join([last, below])
    item.tail = _last_sentence(both)
    same = len(item.tail.content) == len(both.content)
    item.long = (item.long and same) or len(item.tail.content) > _LONGEST_SENTENCE
    if item.long:  # else the time would be quadratic
        item.tail = item.tail[-_END:]


def _without_hyphen(above: ScriptText, below: ScriptText) -> ScriptText:
    offsets = [*above.offsets[:-1], *below.offsets]
    return ScriptText(above.content[:-1] + below.content, offsets, above.source)


def _last_sentence(text: ScriptText) -> ScriptText:
    """The last sentence of a text, with its full stop."""
    return text[sentence_bounds(text.content)[-1][0] :]


def _goes_on(item: LineItem, line: ScriptLine, sense: LineSense) -> bool:
    """Whether an item goes on with a line."""
    if line.mark is LineMark.NUMBER:
        return _ends_in_number(item, line, sense) and not sense.stands_alone(item.text)
    if line.mark is not LineMark.NONE:
        return False
    if item.line.heading and item.line.mark is LineMark.BULLET:
        return False  # `# Second floor`
    indented = line.indent > item.line.indent
    key = (item.last.content, line.text.content, item.line.mark, item.long, indented)
    known = sense.one.get(key)
    if known is None:
        if len(sense.one) >= _MOST_KNOWN:
            sense.one.clear()
        known = sense.one[key] = _are_one(item, line, sense)
    return known


def _are_one(item: LineItem, line: ScriptLine, sense: LineSense) -> bool:
    """Whether an item goes on with a line that has no mark. It hangs on nothing but the texts, the
    item's mark, and whether the line stands further to the right."""
    last, below = item.last, line.text
    if sense.stands_alone(below) or sense.counts(last, below):
        return False
    if _NAMED_STEP.match(below.content) and not _TEXTS.fullmatch(last.content):
        return False
    if sense.is_unfinished(last) or (last.content.endswith('"') and below.content[0] == '"'):
        return True
    if item.long or sense.stands_alone(last) or len(last.content) > _LONGEST_SENTENCE:
        return False
    whole = sense.is_complete(last)
    both = join([last, below])
    _, end = sentence_bounds(both.content)[0]
    if end < len(last.content):
        return item.line.mark is LineMark.NONE and whole and sense.is_complete(below)
    rest = both[len(last.content) : end].strip()
    if sense.begins_with_joint(rest):
        return True
    if whole and sense.opens_sentence(rest):
        return False
    marked = item.line.mark is not LineMark.NONE
    indented = marked and line.indent > item.line.indent
    if marked and not indented and whole and below.content[:1].isupper():
        return False  # `Optional:` between two bullets
    if sense.is_complete(both[:end]) or sense.is_beginning(both[:end], end < len(both.content)):
        return True
    if sense.is_complete(rest) or len(last.content) > _LONGEST_STRANGE:
        return False
    if not whole:
        broken = sense.is_broken(item.last_line, below)
        return indented or broken or last.content.endswith("-")
    broken = indented or sense.is_broken(item.last_line, below)
    return (indented or (broken and not marked)) and sense.is_fragment(rest, indented)


def _ends_in_number(item: LineItem, line: ScriptLine, sense: LineSense) -> bool:
    """Whether what looks like a step's number ends the sentence above: `Check checkpoint` and
    below it `4.`"""
    follows = item.line.number is not None and line.number == item.line.number + 1
    if item.long:
        return False
    if line.text.content and (follows or sense.is_complete(line.text)):
        return False
    both = join([item.last, line.unmarked])
    _, end = sentence_bounds(both.content)[0]
    return end > len(item.last.content) and sense.is_complete(both[:end])


def _lies_in(line: ScriptLine, outer: ScriptLine) -> bool:
    """Whether a line lies within another one: a letter under a number, or what is indented."""
    if line.mark is LineMark.NONE:
        return outer.mark is not LineMark.NONE and line.indent > outer.indent
    if outer.mark is LineMark.NONE:
        return False
    if outer.mark is LineMark.NUMBER and line.mark is LineMark.LETTER:
        return True
    return line.indent > outer.indent


def _is_listed(line: ScriptLine, outer: LineItem, sense: LineSense) -> bool:
    """Whether a line is one of those that an unmarked one announces: `Do the following twice:`."""
    if outer.line.mark is not LineMark.NONE or line.mark is LineMark.NONE:
        return False
    indented = line.indent > outer.line.indent
    return (indented or line.mark is not LineMark.NUMBER) and sense.announces(outer.last)
