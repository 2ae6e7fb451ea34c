"""Parses statements by their shape, so that the parser runs once for all that are alike.

The shape of a statement is its text with a stand-in for every number, quoted text and word that is
not a word of the language. The parser makes no difference between two of them, so what it finds
out about the shape holds for the statement: the same tree, or the same stumble, with the positions
moved by as much as the stand-ins are shorter or longer.
"""

import re
from bisect import bisect_right
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any

from lark import Token, Tree

_ALIKE = frozenset(["WORD", "STRING", "NUMBER", "ORDINAL", "OTHER"])
"""terminals whose pattern makes no difference between two numbers, names or quoted texts"""
_NUMBER = re.compile(r"[0-9]+")
_NUMBERS = re.compile(r"([0-9]+)")
_LETTERS = re.compile(r"\w+")
_LONGEST = 400
"""parts in a shape that is kept, three for each piece"""
_MOST = 1024
"""shapes that are kept"""
_UNKNOWN: Any = object()


class StumbleError(Exception):
    """The parser can't go on from `token`; it would with one of the terminals `accepted`."""

    def __init__(self, token: Token, accepted: frozenset[str]) -> None:
        super().__init__(token)
        self.token = token
        self.accepted = accepted


Parse = Callable[[str, str], Tree[Token]]
"""parses a text, in lower case, by a rule of the grammar; raises StumbleError"""


@dataclass(frozen=True, slots=True)
class SyntaxToken:
    """A token that the grammar keeps; positions are indices in the `positions` of its `Syntax`."""

    type: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class SyntaxNode:
    """A rule's part of a statement. One that covers no text lies at its beginning."""

    rule: str
    start: int
    end: int
    children: "tuple[SyntaxNode | SyntaxToken, ...]"


@dataclass(slots=True)
class Syntax:
    """The tree of a statement, shared by all of its shape, and where its positions lie in it."""

    root: SyntaxNode
    positions: list[int]
    made: dict[type, Any] = field(default_factory=dict)
    """what readers of such trees have made for all of this shape"""


@dataclass(frozen=True, slots=True)
class _Found:
    """What the parser found out about a shape."""

    root: SyntaxNode | SyntaxToken
    """the tree, or the token that the parser stumbled over"""
    positions: tuple[tuple[int, int], ...]
    """each one as a piece and a place in it"""
    accepted: frozenset[str] | None = None
    """set if the parser stumbled: the terminals that it would have gone on with"""
    made: dict[type, Any] = field(default_factory=dict)


Shape = tuple[str, tuple[str, ...], tuple[str, ...], tuple[str, ...]]
"""the rule; then piece by piece what lies between, what is kept, and what has a stand-in"""


class _StandIns(dict[str | None, str]):
    """What stands for a piece, remembered for the words of the language and the latest others.

    Threads share it, so what it has of the words is never taken out.
    """

    def __init__(self, words: Collection[str], make: Callable[[str], str]) -> None:
        super().__init__({word: word for word in words})
        self[None] = ""
        self.make = make
        self.always = frozenset(self)
        self.most = len(self) + _MOST

    def __missing__(self, piece: str) -> str:
        if len(self) > self.most:
            for other in list(self):
                if other not in self.always:
                    self.pop(other, None)
        found = self.make(piece)
        if len(piece) < _LONGEST:
            self[piece] = found
        return found


class Shapes:
    """The shapes of statements that a parser has met, with what it found out about them."""

    def __init__(self, parse: Parse, words: Collection[str], patterns: Mapping[str, str]) -> None:
        """For a grammar of these words, whose other terminals have these regular expressions."""
        special = [pattern for name, pattern in patterns.items() if name not in _ALIKE]
        # A pattern that counts figures tells numbers apart.
        self._counted = re.compile("|".join(p for p in special if "{" in p) or "(?!)")
        # What follows a number without a blank is a unit or the end of an ordinal.
        kept = "|".join([*special, r"(?<=[0-9])[^\W\d_]\w*"])
        alike = "|".join([*(patterns[n] for n in ("STRING", "WORD") if n in patterns), "[0-9]+"])
        self._pieces = re.compile(f"({kept})|({alike})")
        self._kept = _StandIns((), self._keep)
        self._alike = _StandIns(words, _stand_in)
        self._parse = parse
        self._found: dict[Shape, _Found | None] = {}
        self._by_numbers: dict[tuple[str, ...], _Found] = {}
        """those found for texts that differ in their figures only, which is told much sooner"""

    def tree(self, start: str, text: str) -> Syntax:
        """The tree of `text`, in lower case, by the rule `start`; raises StumbleError."""
        pieces = _NUMBERS.split(text)
        key = (start, *pieces[0::2])
        found = self._by_numbers.get(key)
        if found is None:
            syntax = self._by_shape(start, text)
            if len(pieces) < _LONGEST and not self._counted.search(text):
                self._remember(key, pieces, syntax)
            return syntax
        if self._counted.search(text):
            return self._by_shape(start, text)
        starts = list(accumulate(map(len, pieces), initial=0))
        at = [starts[piece] + place for piece, place in found.positions]
        assert isinstance(found.root, SyntaxNode)
        return Syntax(found.root, at, found.made)

    def _remember(self, key: tuple[str, ...], pieces: list[str], syntax: Syntax) -> None:
        starts = list(accumulate(map(len, pieces), initial=0))[:-1]
        positions = []
        for position in syntax.positions:
            piece = bisect_right(starts, position) - 1
            place = position - starts[piece]
            if place and piece % 2 and place < len(pieces[piece]):
                return
            positions.append((piece, place))
        if len(self._by_numbers) >= _MOST:
            self._by_numbers.clear()
        self._by_numbers[key] = _Found(syntax.root, tuple(positions), made=syntax.made)

    def _by_shape(self, start: str, text: str) -> Syntax:
        pieces: list[str] = self._pieces.split(text)
        if len(pieces) > _LONGEST:
            return self.plain_tree(start, text)
        shape = self._shape(start, pieces)
        found = self._found.get(shape, _UNKNOWN)
        if found is _UNKNOWN:
            if len(self._found) >= _MOST:
                self._found.clear()
            found = self._found[shape] = self._examine(shape)
        if found is None:
            return self.plain_tree(start, text)
        starts = list(accumulate([len(p) if p else 0 for p in pieces], initial=0))
        at = [starts[piece] + place for piece, place in found.positions]
        if found.accepted is not None:
            assert isinstance(found.root, SyntaxToken)
            first, end = at[found.root.start], at[found.root.end]
            token = Token(found.root.type, text[first:end], first, end_pos=end)
            raise StumbleError(token, found.accepted)
        assert isinstance(found.root, SyntaxNode)
        return Syntax(found.root, at, found.made)

    def plain_tree(self, start: str, text: str) -> Syntax:
        """As `tree`, always by the parser."""
        positions: dict[int, int] = {}
        root = _branch(
            self._parse(start, text), lambda at: positions.setdefault(at, len(positions))
        )
        return Syntax(root, list(positions))

    def _shape(self, start: str, pieces: list[str]) -> Shape:
        kept, alike = self._kept.__getitem__, self._alike.__getitem__
        return (
            start,
            tuple(pieces[0::3]),
            tuple(map(kept, pieces[1::3])),
            tuple(map(alike, pieces[2::3])),
        )

    def _keep(self, piece: str) -> str:
        return piece if self._counted.fullmatch(piece) else _NUMBER.sub("0", piece)

    def _examine(self, shape: Shape) -> _Found | None:
        """What the parser finds out about a shape; None if that need not hold for what it is of."""
        start, between, kept, alike = shape
        pieces = [between[0]]
        for triple in zip(kept, alike, between[1:], strict=True):
            pieces += triple
        text = "".join(pieces)
        if self._shape(start, self._pieces.split(text)) != shape:
            return None
        starts = list(accumulate(map(len, pieces), initial=0))
        positions: dict[tuple[int, int], int] = {}

        def index(position: int) -> int:
            piece = bisect_right(starts, position) - 1
            return positions.setdefault((piece, position - starts[piece]), len(positions))

        accepted = None
        root: SyntaxNode | SyntaxToken
        try:
            root = _branch(self._parse(start, text), index)
        except StumbleError as stumble:
            at = len(text) if stumble.token.type == "$END" else stumble.token.start_pos or 0
            root = _leaf(stumble.token, at, index)
            accepted = stumble.accepted
        if any(place and piece % 3 for piece, place in positions):
            return None
        return _Found(root, tuple(positions), accepted)


def _stand_in(piece: str) -> str:
    if piece[0] == '"':
        return '"q"'
    if piece[0].isdecimal():
        return "0"
    # A letter for each part of `r-25`, so that no pattern takes it for one word.
    return "q" if piece.isalnum() else _LETTERS.sub("q", piece)


def _branch(tree: Tree[Token], index: Callable[[int], int]) -> SyntaxNode:
    # No rule of the grammars contains itself, so the trees are shallow.
    children = tuple(
        _branch(c, index) if isinstance(c, Tree) else _leaf(c, c.start_pos or 0, index)
        for c in tree.children
    )
    meta = tree.meta
    start, end = (0, 0) if meta.empty else (meta.start_pos, meta.end_pos)
    return SyntaxNode(str(tree.data), index(start), index(end), children)


def _leaf(token: Token, at: int, index: Callable[[int], int]) -> SyntaxToken:
    return SyntaxToken(token.type, index(at), index(at + len(token)))
