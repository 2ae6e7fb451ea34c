"""Script text to syntax tree."""

import re
from collections.abc import Collection

from argo_compiler.garbage_collector import collector_held
from argo_compiler.script.syntax.building.sentences import build
from argo_compiler.script.syntax.fields import Fields
from argo_compiler.script.syntax.grammar import Branch, StumbleError, sentence_grammar
from argo_compiler.script.syntax.healing import heal
from argo_compiler.script.syntax.layout import Item, Mark, items_of, lines_of
from argo_compiler.script.syntax.spelling import respell
from argo_compiler.script.syntax.source import Diagnostics, ScriptText, Source
from argo_compiler.script.syntax.tree.facts import Fact
from argo_compiler.script.syntax.tree.orders import Sentence
from argo_compiler.script.syntax.tree.script import Script, Step, Text
from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.language import Language
from argo_compiler.script.syntax.words.lexer import words
from argo_compiler.script.syntax.words.word import Word

_SENTENCE_END = re.compile(
    r"(?:[.!?…]+|;(?=\s*(?:if|otherwise|else|when)\b))(?=\s|$)", re.IGNORECASE
)
_ABBREVIATION = re.compile(r"\b(?:no|nr|approx|ca|max|min|e\.g|i\.e|z\.b)\.$", re.IGNORECASE)
_GREETING = re.compile(
    r"(?:hello|hi|dear|hey|good (?:morning|afternoon|evening)|hallo|guten|liebe[rs]?)\b.{0,60},?$",
    re.IGNORECASE,
)
_CLOSING = re.compile(
    r"(?:(?:best|kind|warm|many)\s+(?:regards|wishes|thanks)|regards|thanks|thank you|cheers|"
    r"yours|sincerely|viele grüße|mit freundlichen grüßen|danke)\b.{0,30}$",
    re.IGNORECASE,
)
_REMARK = re.compile(r"[_(]*(?:hints?|notes?|remarks?|please note|n\.?b\.?)\s*:", re.IGNORECASE)


@collector_held()
def parse(text: str, vocabulary: Collection[str] = (), source_name: str = "script") -> Script:
    """The syntax tree of the script, with all that was found on the way in its `diagnostics`."""
    source = Source(text, source_name)
    return _Parser(source, Language.of(text, vocabulary)).script(vocabulary)


class _Parser:
    """Reads one script."""

    def __init__(self, source: Source, language: Language) -> None:
        self.source = source
        self.language = language
        self.grammar = sentence_grammar()
        self.diagnostics = Diagnostics(source)
        self.remarks: list[Text] = []
        self.fields = Fields(self.diagnostics, self)
        self.closed = False
        self.begun = False
        """whether anything but a title has been read"""

    def script(self, vocabulary: Collection[str]) -> Script:
        healed = heal(self.source, {*vocabulary, *self.language.words})
        self.diagnostics.entries.extend(healed.diagnostics)
        lines = list(lines_of(healed.lines))
        items = items_of(lines, self.is_complete, self.stands_alone)
        steps = [step for item in items if (step := self._step(item)) is not None]
        return Script(
            source_name=self.source.name,
            source_text=self.source.text,
            header=self.fields.header,
            steps=tuple(steps),
            remarks=tuple(self.remarks),
            diagnostics=self.diagnostics.by_place(),
        )

    def stands_alone(self, text: ScriptText) -> bool:
        """Whether a line never goes on with the one above it."""
        content = text.content
        return bool(
            self.fields.is_field(text)
            or _REMARK.match(content)
            or _GREETING.match(content)
            or _CLOSING.match(content)
        )

    def is_complete(self, text: ScriptText) -> bool:
        """Whether a text makes sense by itself."""
        if self.fields.is_field(text) or _REMARK.match(text.content):
            return True
        return all(self._fits(sentence) for sentence in sentences(text))

    def _fits(self, text: ScriptText) -> bool:
        found = words(text.content, self.language.lexicon)
        if not found or any(word.type == "WORD" for word in found):
            return False
        try:
            tree = self.grammar.tree(tuple(word.type for word in found))
        except StumbleError:
            return False
        last = found[-1]
        return not (last.type == "KIND" and not last.value[2]) and not _is_amend(tree)

    def _step(self, item: Item) -> Step | None:
        inner = [step for i in item.items if (step := self._step(i)) is not None]
        if self._is_remark(item):
            self._remark(item.text)
            return None
        if self.fields.is_field(item.text):
            self.begun = True
            item.text = self.fields.read(item.text)
        said: list[Sentence | Fact] = []
        for text in sentences(item.text):
            node = self._sentence(text, item)
            if node is not None:
                said.append(node)
        if not said and not inner:
            return None
        return Step(
            span=item.text.span(),
            number=item.line.number,
            sentences=tuple(said),
            steps=tuple(inner),
        )

    def _is_remark(self, item: Item) -> bool:
        content = item.text.content
        if self.closed or _REMARK.match(content):
            return True
        if _CLOSING.match(content):
            self.closed = True
            return True
        return bool(_GREETING.match(content))

    def _remark(self, text: ScriptText) -> None:
        self.remarks.append(Text(span=text.span(), text=text.content))

    def _sentence(self, text: ScriptText, item: Item) -> Sentence | Fact | None:
        parsed = self._parsed(text)
        if isinstance(parsed, StumbleError):
            respelled = self._respelled(text)
            if respelled is not None:
                text = respelled
                parsed = self._parsed(text)
        if isinstance(parsed, StumbleError):
            if self._is_heading(text, item):
                self._remark(text)
                if not self.begun and self.fields.header.title is None:
                    self.fields.header.title = Text(span=text.span(), text=text.content)
            else:
                self._not_understood(text, parsed)
            return None
        self.begun = True
        errors = self.diagnostics.errors
        tree, found = parsed
        node = build(tree, found, text, self.diagnostics)
        return node if self.diagnostics.errors == errors else None

    def _parsed(self, text: ScriptText) -> tuple[Branch, list[Word]] | StumbleError:
        found = words(text.content, self.language.lexicon)
        try:
            return self.grammar.tree(tuple(word.type for word in found)), found
        except StumbleError as stumble:
            return stumble

    def _respelled(self, text: ScriptText) -> ScriptText | None:
        """The text with misspelt words put right, if it makes sense then."""
        found: list[tuple[int, int, str]] = []
        for word in words(text.content, self.language.lexicon):
            if word.type == "WORD":
                meant = respell(str(word.value), self.language.words)
                if meant is not None:
                    found.append((word.start, word.end, meant))
        fixed = text
        for start, end, meant in reversed(found):
            fixed = fixed.replace(start, end, meant)
        if not found or isinstance(self._parsed(fixed), StumbleError):
            return None
        for start, end, meant in found:
            message = f"read `{text.content[start:end]}` as `{meant}`"
            self.diagnostics.warning("respelled", message, text.span(start, end))
        return fixed

    def _is_heading(self, text: ScriptText, item: Item) -> bool:
        """Whether a text that makes no sense by itself is a title or a heading: it asks for
        nothing, and stands before what does."""
        types = [word.type for word in words(text.content, self.language.lexicon)]
        if not self.begun and self.fields.header.title is None and item.line.number is None:
            return not _ASKING & set(types) and not set(types[:1]) & set(VERBS)
        return item.line.mark is not Mark.NUMBER and bool(types) and set(types) <= _HEADING

    def _not_understood(self, text: ScriptText, stumble: StumbleError) -> None:
        found = words(text.content, self.language.lexicon)
        unknown = next((w for w in found if w.type == "WORD"), None)
        at = unknown or (found[stumble.at] if stumble.at < len(found) else None)
        if at is None:
            message = "the sentence ends where more is expected"
            span = text.span(len(text.content))
        else:
            message = f"can't understand `{text.content[at.start : at.end]}` here"
            span = text.span(at.start, at.end)
        self.diagnostics.error("not-understood", message, span, "write it in other words")


_ASKING = frozenset(["IF", "UNLESS", "ELSE", "EVENT", "NEXT", "NOT", "EXCEPT", "START", "HOME"])
"""what no title has"""
_HEADING = frozenset(["WORD", "FLOOR", "NUMBER", "ORDINAL", "FLOOR_NAME", "STEP", "JOINT"])


def _is_amend(tree: Branch) -> bool:
    """Whether a sentence says nothing but a manner."""
    _, parts, _, _ = tree
    first = parts[0]
    if isinstance(first, int) or first[0] != "order":
        return False
    order = first[1][-1]
    return not isinstance(order, int) and order[0] == "amend"


def sentences(text: ScriptText) -> list[ScriptText]:
    """The sentences of a text, without their full stops."""
    found: list[ScriptText] = []
    start = 0
    quoted = [m.span() for m in re.finditer(r'"(?:[^"\\]|\\.)*"', text.content)]
    for end in _SENTENCE_END.finditer(text.content):
        if any(a < end.start() < b for a, b in quoted):
            continue
        goes_on = not text.content[end.end() :].lstrip()[:1].isupper()
        if goes_on and end.end() < len(text.content):
            if _ABBREVIATION.search(text.content[: end.start() + 1]):
                continue
        found.append(text[start : end.start()].strip())
        start = end.end()
    found.append(text[start:].strip())
    return [sentence for sentence in found if sentence.content]
