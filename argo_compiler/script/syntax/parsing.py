"""Script text to syntax tree."""

import re
from collections.abc import Collection

from argo_compiler.garbage_collector import collector_held
from argo_compiler.script.syntax.building.sentences import build
from argo_compiler.script.syntax.fields import Fields
from argo_compiler.script.syntax.grammar import StumbleError, sentence_grammar
from argo_compiler.script.syntax.healing import heal
from argo_compiler.script.syntax.layout import Item, items_of, lines_of
from argo_compiler.script.syntax.source import Diagnostics, ScriptText, Source
from argo_compiler.script.syntax.tree.facts import Fact
from argo_compiler.script.syntax.tree.orders import Sentence
from argo_compiler.script.syntax.tree.script import Script, Step, Text
from argo_compiler.script.syntax.words.language import Language
from argo_compiler.script.syntax.words.lexer import words

_SENTENCE_END = re.compile(r"(?:[.!?…]+|;(?=\s*(?:if|otherwise|else|when)\b))(?=\s|$)", re.IGNORECASE)
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
        items = items_of(lines, self.is_complete)
        steps = [step for item in items if (step := self._step(item)) is not None]
        return Script(
            source_name=self.source.name,
            source_text=self.source.text,
            header=self.fields.header,
            steps=tuple(steps),
            remarks=tuple(self.remarks),
            diagnostics=self.diagnostics.by_place(),
        )

    def is_complete(self, text: ScriptText) -> bool:
        """Whether a text makes sense by itself."""
        if self.fields.label(text) is not None:
            return True
        return all(self._fits(sentence) for sentence in sentences(text))

    def _fits(self, text: ScriptText) -> bool:
        found = words(text.content, self.language.lexicon)
        if any(word.type == "WORD" for word in found):
            return False
        try:
            self.grammar.tree(tuple(word.type for word in found))
        except StumbleError:
            return False
        last = found[-1]
        return not (last.type == "KIND" and not last.value[2])

    def _step(self, item: Item) -> Step | None:
        inner = [step for i in item.items if (step := self._step(i)) is not None]
        if self._is_remark(item):
            self._remark(item.text)
            return None
        if self.fields.read(item.text):
            self.begun = True
            return None
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
        found = words(text.content, self.language.lexicon)
        try:
            tree = self.grammar.tree(tuple(word.type for word in found))
        except StumbleError as stumble:
            if not self.begun and self.fields.header.title is None:
                self.fields.header.title = Text(span=text.span(), text=text.content)
                return None
            at = found[stumble.at] if stumble.at < len(found) else None
            span = text.span(at.start, at.end) if at else text.span(len(text.content))
            what = f"can't understand `{text.content[at.start : at.end]}` here" if at else "more is expected"
            self.diagnostics.error("not-understood", what, span, "write it in other words")
            return None
        self.begun = True
        errors = self.diagnostics.errors
        node = build(tree, found, text, self.diagnostics)
        return node if self.diagnostics.errors == errors else None


def sentences(text: ScriptText) -> list[ScriptText]:
    """The sentences of a text, without their full stops."""
    found: list[ScriptText] = []
    start = 0
    quoted = [m.span() for m in re.finditer(r'"(?:[^"\\]|\\.)*"', text.content)]
    for end in _SENTENCE_END.finditer(text.content):
        if any(a < end.start() < b for a, b in quoted):
            continue
        if _ABBREVIATION.search(text.content[: end.start() + 1]):
            continue
        found.append(text[start : end.start()].strip())
        start = end.end()
    found.append(text[start:].strip())
    return [sentence for sentence in found if sentence.content]
