"""Parses one statement with a Lark grammar, and says what is wrong with one that does not fit.

The parser itself finds misspelt words: where it stumbles it knows which words it would have
accepted, and a word is respelled to one of those alone.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache

from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedToken
from lark.lark import PostLex
from lark.lexer import PatternStr
from lark.parsers.lalr_interactive_parser import InteractiveParser

from argo_compiler.script.source import Findings, Text
from argo_compiler.script.spelling import alternatives, most_alike, nearest, respell

_MOST_EXPECTED = 8
"""continuations that a hint lists; of more it shows the nearest"""


class _WholeWords(PostLex):
    """Lets WORD match everywhere, so that no keyword is found at the start of a longer word."""

    always_accept = ("WORD",)

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        return stream


@dataclass(frozen=True)
class Grammar:
    """A grammar of statements, and what can be read off it."""

    parser: Lark
    keywords: dict[str, str]
    """the words of the language, by the name of their terminal"""
    signs: dict[str, str]
    """the punctuation, by the name of its terminal"""
    number_words: frozenset[str]
    forms: tuple[str, ...]
    """one example of each statement"""
    _accepted: dict[tuple[int, ...], frozenset[str]] = field(default_factory=dict)
    """what `accepted` found out, for it is slow: the parser tries every terminal"""

    def accepted(self, parser: InteractiveParser) -> frozenset[str]:
        """The terminals that the parser would go on with; its stack of states decides."""
        states = tuple(parser.parser_state.state_stack)
        if states not in self._accepted:
            names = parser.accepts()  # type: ignore[no-untyped-call]  # lark leaves it untyped
            self._accepted[states] = frozenset(names)
        return self._accepted[states]

    def openings(self, start: str) -> frozenset[str]:
        """The words that a statement of the rule `start` may begin with."""
        accepted = self.accepted(self.parser.parse_interactive("", start))
        return frozenset(self.keywords[name] for name in accepted if name in self.keywords)


@cache
def load_grammar(name: str, starts: tuple[str, ...], forms: tuple[str, ...]) -> Grammar:
    """The grammar in `<name>.lark` beside this module; `starts` are the rules to parse by."""
    parser = Lark.open_from_package(
        __package__,
        f"{name}.lark",
        parser="lalr",
        start=list(starts),
        propagate_positions=True,
        maybe_placeholders=False,
        postlex=_WholeWords(),
    )
    fixed = {t.name: t.pattern.value for t in parser.terminals if isinstance(t.pattern, PatternStr)}
    keywords = {name: value for name, value in fixed.items() if value[0].isalpha()}
    signs = {name: value for name, value in fixed.items() if name not in keywords}
    number_words = frozenset(
        keywords[symbol.name]
        for rule in parser.rules
        if rule.origin.name in ("number_word", "ordinal_word")
        for symbol in rule.expansion
    )
    return Grammar(parser, keywords, signs, number_words, forms)


class _StumbleError(Exception):
    """The parser can't go on from `token`; it would with one of the terminals `accepted`."""

    def __init__(self, token: Token, accepted: frozenset[str]) -> None:
        super().__init__(token)
        self.token = token
        self.accepted = accepted


@dataclass(frozen=True)
class Parsed:
    """A statement's tree; its positions are those of `text`, in which words may be respelled."""

    tree: Tree[Token]
    text: Text


def parse_statement(grammar: Grammar, start: str, text: Text, findings: Findings) -> Parsed | None:
    """Parses `text` by the rule `start`, misspelt words respelled with a warning each.

    None if it can't be understood; `findings` then has one error more.
    """
    original = text
    respelled: list[tuple[int, str, str]] = []
    # Each turn makes one word a word of the language, and such words are not touched again.
    while True:
        try:
            tree = _parse(grammar, start, text)
        except _StumbleError as stumble:
            word = _respelling(grammar, stumble)
            if word is None:
                _report(grammar, stumble, original, text, findings)
                return None
            at, end = _extent(stumble.token, text)
            respelled.append((at, text.content[at:end], word))
            text = text.replace(at, end, word)
        else:
            for at, old, new in respelled:
                message = f"read `{old}` as `{new}`"
                findings.warning("respelled", message, text.span(at, at + len(new)))
            return Parsed(tree, text)


def matches(grammar: Grammar, start: str, text: Text) -> bool:
    """Whether the rule `start` accepts `text` as it is spelled."""
    try:
        _parse(grammar, start, text)
    except _StumbleError:
        return False
    return True


def _parse(grammar: Grammar, start: str, text: Text) -> Tree[Token]:
    parser = grammar.parser.parse_interactive(lower(text.content), start)
    try:
        parser.exhaust_lexer()
        tree: Tree[Token] = parser.feed_token(Token("$END", ""))
    except UnexpectedToken as error:
        raise _StumbleError(error.token, grammar.accepted(parser)) from error
    return tree


def lower(text: str) -> str:
    """`text` in lower case, character by character: no position moves."""
    return "".join(c.lower() if len(c.lower()) == 1 else c for c in text)


def _respelling(grammar: Grammar, stumble: _StumbleError) -> str | None:
    word = str(stumble.token)
    if stumble.token.type == "$END" or word in grammar.keywords.values():
        return None
    return respell(word, (grammar.keywords[n] for n in stumble.accepted if n in grammar.keywords))


def _extent(token: Token, text: Text) -> tuple[int, int]:
    if token.type == "$END":
        return len(text.content), len(text.content)
    assert token.start_pos is not None
    return token.start_pos, token.start_pos + len(token)


_READABLE = {
    "$END": "the end of the line",
    "WORD": "a name",
    "NUMBER": "a number",
    "ORDINAL": "a number such as `1st`",
    "STARTING_AREA": "`starting area`",
}


def _report(
    grammar: Grammar, stumble: _StumbleError, original: Text, text: Text, findings: Findings
) -> None:
    at, end = _extent(stumble.token, text)
    accepted = stumble.accepted
    words = sorted(grammar.keywords[n] for n in accepted if n in grammar.keywords)
    if "NUMBER" in accepted:
        # The numbers as words would bury all else.
        words = [word for word in words if word not in grammar.number_words]
    expected = [_READABLE[name] for name in sorted(accepted) if name in _READABLE]
    expected += [f"`{word}`" for word in words]
    expected += [f"`{grammar.signs[name]}`" for name in sorted(accepted) if name in grammar.signs]

    if at == end:
        message = "the line ends where more is expected"
    else:
        message = f"can't understand `{text.content[at:end]}` here"
    hint = ""
    if len(expected) <= _MOST_EXPECTED:
        hint = f"expected {alternatives(expected)}; "
    elif close := nearest(str(stumble.token), words):
        hint = f"a word that fits here: {alternatives(f'`{w}`' for w in close)}; "
    form = most_alike(original.content, grammar.forms)
    span = text.span(at, end) if at < end else text.span(end)
    findings.error("not-understood", message, span, f"{hint}write a line such as: {form}")
