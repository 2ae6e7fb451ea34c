"""The parser of sentences: words in, a tree of rules out."""

from dataclasses import dataclass, field
from functools import cache

from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedToken

from argo_compiler.script.sentences.grammar.tables import load_parser

Branch = tuple[str, tuple["Branch | int", ...], int, int]
"""a rule, its parts, and which words it covers, from the first to behind the last; a part is a
branch or the place of a word in the sentence"""


class StumbleError(Exception):
    """The parser can't go on from word `at`."""

    def __init__(self, at: int) -> None:
        super().__init__(at)
        self.at = at


@dataclass
class Grammar:
    """A parser, and the trees of the sentences it has met, by the types of their words."""

    parser: Lark
    _known: dict[tuple[str, ...], Branch | int] = field(default_factory=dict)
    """the tree, or the word at which the parser stumbles"""
    _accepted: dict[tuple[str, ...], frozenset[str]] = field(default_factory=dict)

    _MOST = 4096

    def tree(self, words: tuple[str, ...], start: str = "sentence") -> Branch:
        """The tree of a sentence, or of what `start` names, whose words have these types; raises
        StumbleError."""
        key = words if start == "sentence" else (start, *words)
        found = self._known.get(key)
        if found is None:
            if len(self._known) >= self._MOST:
                self._known.clear()
            self._known[key] = found = self._parse(words, start)
        if isinstance(found, int):
            raise StumbleError(found)
        return found

    def _parse(self, words: tuple[str, ...], start: str) -> Branch | int:
        parser = self.parser.parse_interactive("", start)
        at = 0
        try:
            for at, type_ in enumerate(words):
                parser.feed_token(Token(type_, "", start_pos=at, end_pos=at + 1))
            at = len(words)
            tree = parser.feed_token(Token("$END", "", start_pos=at, end_pos=at))
        except UnexpectedToken:
            return at
        return _branch(tree)

    def begins(self, words: tuple[str, ...]) -> bool:
        """Whether a sentence may begin with words of these types."""
        try:
            self.tree(words)
        except StumbleError as stumble:
            return stumble.at == len(words)
        return True

    def accepted(self, words: tuple[str, ...]) -> frozenset[str]:
        """The types of words with which a sentence that begins with these may go on."""
        found = self._accepted.get(words)
        if found is None:
            if len(self._accepted) >= self._MOST:
                self._accepted.clear()
            self._accepted[words] = found = self._accept(words)
        return found

    def _accept(self, words: tuple[str, ...]) -> frozenset[str]:
        parser = self.parser.parse_interactive("", "sentence")
        for at, type_ in enumerate(words):
            parser.feed_token(Token(type_, "", start_pos=at, end_pos=at + 1))
        return frozenset(parser.accepts())  # type: ignore[no-untyped-call]


def _branch(tree: Tree[Token]) -> Branch:
    parts = tuple(_branch(c) if isinstance(c, Tree) else c.start_pos or 0 for c in tree.children)
    meta = tree.meta
    first, behind = (0, 0) if meta.empty else (meta.start_pos, meta.end_pos)
    return str(tree.data), parts, first, behind


@cache
def sentence_grammar() -> Grammar:
    """The grammar in `sentence.lark` beside this module."""
    return Grammar(load_parser())
