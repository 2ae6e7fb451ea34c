"""Makes sentences from the grammar: a derivation at random, each of its words said by a phrase of a
language at random."""

import random
from collections import defaultdict
from dataclasses import dataclass
from functools import cache

from lark.grammar import NonTerminal, Rule, Symbol

from argo_compiler.script.syntax.grammar.parser import sentence_grammar
from argo_compiler.script.syntax.tree.nouns import Kind
from argo_compiler.script.syntax.words.language import Language
from argo_compiler.script.syntax.words.lexicon import Lexicon
from tests.argo_compiler.script.conftest import CATALOG

_DEEPEST = 8
"""rules in one another before the shortest way out is taken"""
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
_FIGURES = {
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
class Said:
    """A word of a made sentence: its terminal, and how it is said."""

    type: str
    text: str


class Sayer:
    """Makes sentences."""

    def __init__(self, lexicon: Lexicon, rng: random.Random) -> None:
        self.rng = rng
        self.lexicon = lexicon
        self.rules: dict[str, list[Rule]] = defaultdict(list)
        for rule in sentence_grammar().parser.rules:
            self.rules[rule.origin.name].append(rule)
        depths = _depths(self.rules)
        self.shortest: dict[str, list[Rule]] = {}
        """by name, the rules with the shortest way out"""
        for name, rules in self.rules.items():
            least = min(depths[id(rule)] for rule in rules)
            self.shortest[name] = [rule for rule in rules if depths[id(rule)] == least]
        self.phrases: dict[str, list[str]] = defaultdict(list)
        self.meanings: dict[Said, object] = {}
        """of phrases: what each is, in one number or several"""
        for (type_, value), phrases in lexicon.phrases.items():
            self.phrases[type_] += phrases
            meaning = value[0] if isinstance(value, tuple) else value
            self.meanings.update((Said(type_, phrase), meaning) for phrase in phrases)

    def sentence(self, start: str = "sentence") -> list[Said]:
        """The words of a sentence, mostly a short one: a long one has a mistake somewhere."""
        longest = self.rng.choice((8, 12, 20, 40))
        types = None
        while types is None:
            types = self._derived(start, longest)
        return [Said(type_, self.word(type_)) for type_ in types]

    def others(self, word: Said) -> list[str]:
        """The phrases of the same terminal that mean something else."""
        same = (*_ANY_KIND, self.meanings.get(word))
        return [p for p in self.phrases[word.type] if self.meanings[Said(word.type, p)] not in same]

    def word(self, type_: str) -> str:
        """A phrase for a terminal."""
        if type_.startswith(("AND_", "OR_")):
            joint = "or" if type_.startswith("OR_") else "and"
            return self.rng.choice(
                (f" {joint} ", f", {joint} ", ", ") if joint == "and" else (" or ",)
            )
        known = _SIGNS.get(type_) or _FIGURES.get(type_)
        if known is not None:
            return self.rng.choice(known)
        listed = self.phrases.get(type_) or self.phrases.get(_SENSES.get(type_, ""))
        return self.rng.choice(listed) if listed else type_.lower()

    def _derived(self, start: str, longest: int) -> list[str] | None:
        """The terminals of a sentence; None if there are more than that."""
        found: list[str] = []
        stack: list[tuple[Symbol, int]] = [(NonTerminal(start), 0)]
        random = self.rng.random
        while stack:
            symbol, depth = stack.pop()
            if symbol.is_term:
                found.append(symbol.name)
                if len(found) > longest:
                    return None
                continue
            rules = (self.shortest if depth >= _DEEPEST else self.rules)[symbol.name]
            rule = rules[int(random() * len(rules))]
            stack += [(part, depth + 1) for part in reversed(rule.expansion)]
        return found


_ANY_KIND = (Kind.CHECKPOINT, Kind.GAUGE)
"""these are said of checkpoints of several kinds"""
_SENSES = {"IF_ONLY": "IF"}
"""terminals that the lexer makes of others by what stands beside them"""


def _depths(rules: dict[str, list[Rule]]) -> dict[int, int]:
    """How deep a derivation by each rule is at least."""
    depths: dict[str, int] = {}
    found: dict[int, int] = {}
    changed = True
    while changed:
        changed = False
        for name, options in rules.items():
            for rule in options:
                parts = [0 if part.is_term else depths.get(part.name) for part in rule.expansion]
                if any(part is None for part in parts):
                    continue
                depth = 1 + max((part for part in parts if part is not None), default=0)
                if depth < found.get(id(rule), depth + 1):
                    found[id(rule)] = depth
                    changed = True
                if depth < depths.get(name, depth + 1):
                    depths[name] = depth
                    changed = True
    return found


@cache
def _lexicon() -> Lexicon:
    return Language.of("check", tuple(place.name for place in CATALOG.places)).lexicon


def text_of(words: list[Said]) -> str:
    """The sentence as it is written."""
    text = ""
    for word in words:
        joins = word.text[:1] in " ,;:)]" or text[-1:] in "([ "
        text += word.text if joins or not text else f" {word.text}"
    return " ".join(text.replace(" ,", ",").replace(" :", ":").split())


def sayer(rng: random.Random) -> Sayer:
    """One that speaks English."""
    return Sayer(_lexicon(), rng)
