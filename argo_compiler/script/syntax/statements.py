"""Parses one statement with a Lark grammar, and says what is wrong with one that does not fit.

The parser itself finds misspelt words: where it stumbles it knows which words it would have
accepted, and a word is respelled to one of those alone.
"""

from dataclasses import dataclass, field
from functools import cache, cached_property

from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedToken
from lark.lexer import PatternRE, PatternStr
from lark.parsers.lalr_interactive_parser import InteractiveParser

from argo_compiler.listing import listed
from argo_compiler.script.syntax.shapes import Shapes, StumbleError, Syntax
from argo_compiler.script.syntax.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.spelling import most_alike, nearest, respell
from argo_compiler.script.syntax.tables import load_parser

_MOST_EXPECTED = 8
"""continuations that a hint lists; of more it shows the nearest"""


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
    patterns: dict[str, str]
    """the regular expressions of the other terminals"""
    _accepted: dict[tuple[int, ...], frozenset[str]] = field(default_factory=dict)
    """what `accepted` found out, for it is slow: the parser tries every terminal"""
    _fitting: dict[frozenset[str], frozenset[str]] = field(default_factory=dict)

    @cached_property
    def shapes(self) -> Shapes:
        """Parses as `parse` does, but once for all texts that are alike."""
        return Shapes(self.parse, self.keywords.values(), self.patterns)

    def parse(self, start: str, text: str) -> Tree[Token]:
        """The tree of `text`, in lower case, by the rule `start`; raises StumbleError."""
        parser = self.parser.parse_interactive(text, start)
        try:
            parser.exhaust_lexer()
            tree: Tree[Token] = parser.feed_token(Token("$END", ""))
        except UnexpectedToken as error:
            raise StumbleError(error.token, self.accepted(parser)) from error
        return tree

    def accepted(self, parser: InteractiveParser) -> frozenset[str]:
        """The terminals that the parser would go on with; its stack of states decides."""
        states = tuple(parser.parser_state.state_stack)
        if states not in self._accepted:
            names = parser.accepts()  # type: ignore[no-untyped-call]  # lark leaves it untyped
            self._accepted[states] = frozenset(names)
        return self._accepted[states]

    def fitting(self, accepted: frozenset[str]) -> frozenset[str]:
        """The words of the language among the terminals."""
        words = self._fitting.get(accepted)
        if words is None:
            words = frozenset(self.keywords[name] for name in accepted if name in self.keywords)
            self._fitting[accepted] = words
        return words

    def openings(self, start: str) -> frozenset[str]:
        """The words that a statement of the rule `start` may begin with."""
        return self.fitting(self.accepted(self.parser.parse_interactive("", start)))


@cache
def load_grammar(name: str, starts: tuple[str, ...], forms: tuple[str, ...]) -> Grammar:
    """The grammar in `<name>.lark` beside this module; `starts` are the rules to parse by."""
    parser = load_parser(name, starts)
    fixed = {t.name: t.pattern.value for t in parser.terminals if isinstance(t.pattern, PatternStr)}
    keywords = {name: value for name, value in fixed.items() if value[0].isalpha()}
    signs = {name: value for name, value in fixed.items() if name not in keywords}
    number_words = frozenset(
        keywords[symbol.name]
        for rule in parser.rules
        if rule.origin.name in ("number_word", "ordinal_word")
        for symbol in rule.expansion
    )
    by_priority = sorted(parser.terminals, key=lambda terminal: -terminal.priority)
    patterns = {
        t.name: t.pattern.to_regexp() for t in by_priority if isinstance(t.pattern, PatternRE)
    }
    return Grammar(parser, keywords, signs, number_words, forms, patterns)


@dataclass(frozen=True)
class Parsed:
    """A statement's tree; its positions are those of `text`, in which words may be respelled."""

    tree: Syntax
    text: ScriptText


def parse_statement(
    grammar: Grammar, start: str, text: ScriptText, diagnostics: Diagnostics
) -> Parsed | None:
    """Parses `text` by the rule `start`, misspelt words respelled with a warning each.

    None if it can't be understood; `diagnostics` then has one error more.
    """
    original = text
    respelled: list[tuple[int, str, str]] = []
    # Each turn makes one word a word of the language, and such words are not touched again.
    while True:
        try:
            tree = grammar.shapes.tree(start, lower(text.content))
        except StumbleError as stumble:
            word = _respelling(grammar, stumble)
            if word is None:
                _report(grammar, stumble, original, text, diagnostics)
                return None
            at, end = _extent(stumble.token, text)
            respelled.append((at, text.content[at:end], word))
            text = text.replace(at, end, word)
        else:
            for at, old, new in respelled:
                message = f"read `{old}` as `{new}`"
                diagnostics.warning("respelled", message, text.span(at, at + len(new)))
            return Parsed(tree, text)


def matches(grammar: Grammar, start: str, text: ScriptText) -> bool:
    """Whether the rule `start` accepts `text` as it is spelled."""
    try:
        grammar.shapes.tree(start, lower(text.content))
    except StumbleError:
        return False
    return True


def lower(text: str) -> str:
    """`text` in lower case, character by character: no position moves."""
    if text.isascii():
        return text.lower()
    return "".join(c.lower() if len(c.lower()) == 1 else c for c in text)


def _respelling(grammar: Grammar, stumble: StumbleError) -> str | None:
    word = str(stumble.token)
    if stumble.token.type == "$END" or word in grammar.keywords.values():
        return None
    return respell(word, grammar.fitting(stumble.accepted))


def _extent(token: Token, text: ScriptText) -> tuple[int, int]:
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
    grammar: Grammar,
    stumble: StumbleError,
    original: ScriptText,
    text: ScriptText,
    diagnostics: Diagnostics,
) -> None:
    at, end = _extent(stumble.token, text)
    accepted = stumble.accepted
    words = sorted(grammar.fitting(accepted))
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
        hint = f"expected {listed(expected, 'or')}; "
    elif close := nearest(str(stumble.token), words):
        hint = f"a word that fits here: {listed((f'`{w}`' for w in close), 'or')}; "
    form = most_alike(original.content, grammar.forms)
    span = text.span(at, end) if at < end else text.span(end)
    diagnostics.error("not-understood", message, span, f"{hint}write a line such as: {form}")
