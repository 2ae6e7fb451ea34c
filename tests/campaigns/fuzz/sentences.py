"""Generator of sentences: random derivations of the grammar, with a random phrase for each word."""

import random
from collections import defaultdict
from dataclasses import dataclass
from functools import cache

from lark.grammar import NonTerminal, Rule, Symbol

from argo_compiler.script.sentences.grammar.parser import sentence_grammar
from argo_compiler.script.sentences.tree.nouns import Kind
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexicon import Lexicon
from tests.argo_compiler.script.conftest import CATALOG

_DEPTH_LIMIT = 8
"""depth of nested rules from which only the rules with the shortest derivation are used"""
_SIGNS = {
    "NEXT": (", then ", " and ", ", ", "; "),
    "COLON": (": ",),
    "LPAR": ("(",),
    "LPAR_HOW": ("(",),
    "RPAR": (")",),
    "LSQB": ("[",),
    "RSQB": ("]",),
    "DASH": ("-",),
    "MINUS": ("minus ", "-"),
}
_JOINTS = {"and": (" and ", ", and ", ", "), "or": (" or ", ", or ")}
_VALUES = {
    "NUMBER": ("1", "2", "3", "4", "5", "8", "10", "12", "20", "seven", "2.5"),
    "IDENT": ("R25", "R12", "R7", "R40"),
    "STRING": ('"A"', '"MEASURE 1"', '"front of the site"'),
    "DURATION": ("10 minutes", "90 s", "1 h 30 min", "half an hour", "20'", "2 min"),
    "QUANTITY": ("5 bar", "4,5 bar", "30 %", "10 deg", "50 psi", "2.5 bar"),
    "SPEED": ("0.3 m/s", "1 km/h"),
    "TIMES": ("twice", "three times", "5 times", "once"),
    "ORDINAL": ("first", "second", "3rd"),
    "PLACE": ("the front of the site",),
    "WORD": ("pump",),
}


@dataclass(frozen=True)
class Word:
    """Word of a generated sentence: its terminal and its text."""

    type: str
    text: str


class SentenceGenerator:
    """Generator of sentences in one language."""

    def __init__(self, lexicon: Lexicon, rng: random.Random) -> None:
        self.rng = rng
        self.lexicon = lexicon
        self.rules: dict[str, list[Rule]] = defaultdict(list)
        for rule in sentence_grammar().parser.rules:
            self.rules[rule.origin.name].append(rule)
        depths = _least_depths(self.rules)
        self.shortest: dict[str, list[Rule]] = {}
        """rules with the shortest derivation, by name"""
        for name, rules in self.rules.items():
            minimum = min(depths[id(rule)] for rule in rules)
            self.shortest[name] = [rule for rule in rules if depths[id(rule)] == minimum]
        self.phrases: dict[str, list[str]] = defaultdict(list)
        self.meanings: dict[Word, object] = {}
        """meaning of each phrase, the same in singular and plural"""
        for (type_, value), phrases in lexicon.phrases.items():
            self.phrases[type_] += phrases
            meaning = value[0] if isinstance(value, tuple) else value
            self.meanings.update((Word(type_, phrase), meaning) for phrase in phrases)

    def sentence(self, start: str = "sentence") -> list[Word]:
        """Generate a sentence, usually a short one, as most long ones have an error somewhere."""
        longest = self.rng.choice((8, 12, 20, 40))
        types = None
        while types is None:
            types = self._derive(start, longest)
        return [Word(type_, self.word(type_)) for type_ in types]

    def phrases_with_other_meaning(self, word: Word) -> list[str]:
        """Return the phrases of the same terminal with another meaning."""
        same = (*_ANY_KIND, self.meanings.get(word))
        return [p for p in self.phrases[word.type] if self.meanings[Word(word.type, p)] not in same]

    def word(self, type_: str) -> str:
        """Draw a phrase for a terminal."""
        if type_.startswith(("AND_", "OR_")):
            joint = "or" if type_.startswith("OR_") else "and"
            return self.rng.choice(
                (f" {joint} ", f", {joint} ", ", ") if joint == "and" else (" or ",)
            )
        known = _SIGNS.get(type_) or _VALUES.get(type_)
        if known is not None:
            return self.rng.choice(known)
        listed = self.phrases.get(type_) or self.phrases.get(_SOURCE_TERMINALS.get(type_, ""))
        return self.rng.choice(listed) if listed else type_.lower()

    def _derive(self, start: str, longest: int) -> list[str] | None:
        """Derive the terminals of a sentence; None: there are more than `longest`."""
        terminals: list[str] = []
        stack: list[tuple[Symbol, int]] = [(NonTerminal(start), 0)]
        random = self.rng.random
        while stack:
            symbol, depth = stack.pop()
            if symbol.is_term:
                terminals.append(symbol.name)
                if len(terminals) > longest:
                    return None
                continue
            rules = (self.shortest if depth >= _DEPTH_LIMIT else self.rules)[symbol.name]
            rule = rules[int(random() * len(rules))]
            stack += [(part, depth + 1) for part in reversed(rule.expansion)]
        return terminals


_ANY_KIND = (Kind.CHECKPOINT, Kind.GAUGE)
"""kinds whose phrases stand for checkpoints of several kinds"""
_SOURCE_TERMINALS = {"IF_ONLY": "IF"}
"""terminals that the lexer makes from others, depending on the words beside them"""


def _least_depths(rules: dict[str, list[Rule]]) -> dict[int, int]:
    """Return the least depth of a derivation by each rule, by the rule's id."""
    depths: dict[str, int] = {}
    by_rule: dict[int, int] = {}
    changed = True
    while changed:
        changed = False
        for name, options in rules.items():
            for rule in options:
                parts = [0 if part.is_term else depths.get(part.name) for part in rule.expansion]
                if any(part is None for part in parts):
                    continue
                depth = 1 + max((part for part in parts if part is not None), default=0)
                if depth < by_rule.get(id(rule), depth + 1):
                    by_rule[id(rule)] = depth
                    changed = True
                if depth < depths.get(name, depth + 1):
                    depths[name] = depth
                    changed = True
    return by_rule


@cache
def _lexicon() -> Lexicon:
    return Language.of("check", tuple(place.name for place in CATALOG.places)).lexicon


def text_of(words: list[Word]) -> str:
    """Return the text of a sentence."""
    text = ""
    for word in words:
        joins = word.text[:1] in " ,;:)]" or text[-1:] in "([ "
        text += word.text if joins or not text else f" {word.text}"
    return " ".join(text.replace(" ,", ",").replace(" :", ":").split())


def english_generator(rng: random.Random) -> SentenceGenerator:
    """Return a generator of English sentences."""
    return SentenceGenerator(_lexicon(), rng)
