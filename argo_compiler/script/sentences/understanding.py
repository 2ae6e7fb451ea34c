"""Makes sense of single sentences: words, tree, node; misspelt words are put right where exactly
one reading makes sense."""

import re
from collections.abc import Mapping
from functools import cache
from itertools import islice, product

from argo_compiler.base.listing import listed
from argo_compiler.script.documents.source import Diagnostics, ScriptText, join, quotes
from argo_compiler.script.sentences.building.sentences import build
from argo_compiler.script.sentences.grammar.parser import Branch, StumbleError, sentence_grammar
from argo_compiler.script.sentences.tree.nouns import Kind
from argo_compiler.script.sentences.tree.orders import Fact, Sentence
from argo_compiler.script.sentences.tree.places import FloorName, Location
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexer import words, words_of
from argo_compiler.script.sentences.words.lexicon import Entry, Lexicon, folded
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.prose import either
from argo_compiler.script.sentences.words.spelling import candidates
from argo_compiler.script.sentences.words.unknown import UnknownValue
from argo_compiler.script.sentences.words.word import VERBS, Word

Reading = tuple[Branch, list[Word]]
_AREA = ("AREA", "NUMBER")
"""where a mission starts, or the end of a line before"""
_MOST_SLIPS = 8
"""misspelt words in a sentence; one with more is none of the language's"""
_MOST_TRIED = 32
"""ways to put the misspelt words of a sentence right"""
_MIXED = re.compile(r"(?<![\w.,'-])(?=[lIiOo|]*[0-9])(?=[0-9]*[lIiOo|])([0-9lIiOo|]+)(?![\w|]|-\w)")
_WORD = re.compile(r"(?<![\w.'-])(?=[^\W\d_]*[0-9])[^\W_]{4,}(?![\w-])")
IS_MEANT = " meant?"
"""end of the part of a hint that asks for the right spelling"""
_LETTERS = {"0": "o", "1": "li", "5": "s", "8": "b"}
"""what text recognition takes for figures"""
_DIGITS = str.maketrans("lIi|Oo", "111100")
_LISTED = re.compile(r"([^(),:\d]{3,40}?)\s*[(,]\s*([^():\d]{3,40}?)\)?\s*:\s+(?=\S)")
_SIGN = re.compile(r"[^\w\s.,;:&()\[\]=+'-]")
"""a sign that by itself is a word"""
_QUOTED = re.compile(r'"(?:[^"\\]|\\.)*"')
_ARROW = re.compile(r"\s*(?:-+>|=+>|→|➔|»)\s*")
COMPARING = frozenset(
    [*("LESS", "GREATER", "AT_LEAST", "AT_MOST", "OR_MORE", "OR_LESS", "STATE", "OUTSIDE", "FAILS")]
)
"""types of words before an arrow that make a condition of what stands there"""
_MOST_TOLD = 8
_UNTOLD = frozenset(
    [
        *("STRING", "LPAR_CALLED", "LPAR_BOUND", "SECOND_BOUND", "JOINTS", "STANDING", "SHOWN_IN"),
        *("ABOUT", "LEAVING", "JOINT", "X", "Y", "Z", "RAD", "MODE", "VALUE", "FINISHING"),
        *("STOPPING", "INCLUDED", "EXCLUDED", "ENDLESS", "IN_CIRCLES"),
    ]
)
"""terminals that need not be named, as they are rare"""


class Understanding:
    """Reads sentences of one language."""

    def __init__(self, language: Language, names: frozenset[str], diagnostics: Diagnostics) -> None:
        self.language = language
        self.known = language.words
        self.names = names
        """words of the site's names, in lower case"""
        self.diagnostics = diagnostics
        self.unknown: Mapping[int, UnknownValue] = {}
        """by their places in the source, figures that are to be taken for unknown"""
        self._with_unknown: tuple[object, dict[tuple[int, str], list[Word]]] = ({}, {})
        """words of texts by place and content, and the unknown figures that they have"""
        self.grammar = sentence_grammar()
        self._joint = _joint_at_end(language.lexicon)

    def joints(self, meaning: str) -> list[str]:
        """The words that mean `and`, or `or`."""
        return _joints(self.language.lexicon, meaning)

    def words(self, text: ScriptText) -> list[Word]:
        if self.unknown:
            figures, known = self._with_unknown
            if figures is not self.unknown:
                self._with_unknown = self.unknown, (known := {})
            key = text.first, text.content
            if key not in known:
                places = {offset: i for i, offset in enumerate(text.offsets)}
                unknown = {places[o]: f for o, f in self.unknown.items() if o in places}
                known[key] = words_of(text.content, self.language.lexicon, unknown)
            return known[key]
        return words(text.content, self.language.lexicon)

    def types(self, text: ScriptText) -> tuple[str, ...]:
        return tuple(word.type for word in self.words(text))

    def named_kinds(self, text: ScriptText) -> list[Word]:
        """The nouns of a text for one kind of checkpoint: `valves`, but not `points`."""
        kinds = (word for word in self.words(text) if word.type == "KIND")
        return [word for word in kinds if word.value[0] is not Kind.CHECKPOINT]

    def read(self, text: ScriptText, start: str = "sentence") -> Reading | StumbleError:
        """The tree of a sentence, or of what `start` names, or where the grammar can't go on."""
        found = self.words(text)
        try:
            return self.grammar.tree(tuple(word.type for word in found), start), found
        except StumbleError as stumble:
            return stumble

    def fits(self, text: ScriptText) -> bool:
        """Whether a text makes sense by itself."""
        if self.has_strange_sign(text):
            return False
        found = self.words(text)
        if not found:
            return text.content != ""  # words that mean nothing
        if any(word.type == "WORD" for word in found) or self.unfinished(text) is not None:
            return False
        if text.content.endswith(",") or tuple(w.type for w in found) == _AREA:
            return False
        reading = self.read(text)
        if isinstance(reading, StumbleError):
            return False
        last = found[-1]
        return not (last.type == "KIND" and not last.value[2]) and not _is_amend(reading[0])

    def has_strange_sign(self, text: ScriptText) -> bool:
        """Return True if a text has a sign that is a word of no sentence, so that it can't fit."""
        signs = _SIGN.findall(text.content)
        if '"' in signs:
            signs = _SIGN.findall(_QUOTED.sub("", text.content))
        return bool(signs) and not _signs(self.language.lexicon).issuperset(signs)

    def unfinished(self, text: ScriptText) -> ScriptText | None:
        """The joint with which a text ends, if it does."""
        joint = self._joint.search(text.content)
        return None if joint is None else text[joint.start() : joint.end()]

    def node(self, text: ScriptText, reading: Reading) -> Sentence | Fact | None:
        """What a sentence says; None with an error."""
        errors = self.diagnostics.errors
        node: Sentence | Fact = build(*reading, text, self.diagnostics)
        return node if self.diagnostics.errors == errors else None

    def location(self, text: ScriptText) -> Location | tuple[FloorName, ...] | None:
        """The place that a text names, if it names one and says nothing else."""
        reading = self.read(text, "location")
        if isinstance(reading, StumbleError):
            return None
        where: Location | tuple[FloorName, ...] = build(*reading, text, self.diagnostics)
        return where

    # ---- slips

    def respelled(self, text: ScriptText, quiet: bool = False) -> ScriptText | None:
        """The text with misspelt words put right, if it makes sense then and in one way only; with
        a warning for each, unless it is to be quiet."""
        slips: list[tuple[Word, tuple[str, ...]]] = []
        for word in self.words(text):
            if word.type == "WORD" and str(word.value) not in self.known:
                shown = text.content[word.start : word.end]
                if pattern("<ordinary>").fullmatch(shown) is not None:
                    continue
                meant = candidates(shown, self.known)
                if any(folded(other) in self.language.lexicon.numerals for other in meant):
                    return None  # a number is never guessed
                if meant:
                    slips.append((word, meant))
        if not 0 < len(slips) <= _MOST_SLIPS:
            return None
        found: dict[tuple[tuple[str, str], ...], tuple[ScriptText, tuple[str, ...]]] = {}
        for chosen in islice(product(*(meant for _, meant in slips)), _MOST_TRIED):
            fixed = text
            for (word, _), meant_word in zip(reversed(slips), reversed(chosen), strict=True):
                fixed = fixed.replace(word.start, word.end, meant_word)
            reading = self.read(fixed)
            if isinstance(reading, StumbleError):
                continue
            if all(word.type != "WORD" for word in reading[1]):
                # `guages` are `gauges` or `gages`, which are the same
                said = tuple((word.type, str(word.value)) for word in reading[1])
                found.setdefault(said, (fixed, chosen))
        if len(found) != 1:
            return None
        ((fixed, chosen),) = found.values()
        for (word, _), meant_word in zip(slips, () if quiet else chosen, strict=not quiet):
            self._warn(text, word.start, word.end, meant_word)
        return fixed

    def rewritten(self, text: ScriptText) -> ScriptText:
        """Return a text with contractions in full, and signs as words: `R7 -> R9` is `R7, then
        R9`, `R7 is closed -> R9` a condition, and `Checkpoints (in any order): 1, 4` a list."""
        if "'" in text.content or "’" in text.content:
            for short, full in _contractions(self.language.prose.contractions):
                for found in reversed(list(short.finditer(text.content))):
                    text = text.replace(*found.span(), full)
        listed = _LISTED.match(text.content)
        if listed is not None and self.types(text[: listed.end(1)]) == ("KIND",):
            inner = text[listed.start(2) : listed.end(2)]
            text = join([text[listed.end() :].strip(), inner], ", ")
        arrows = [] if '"' in text.content else list(_ARROW.finditer(text.content))
        if arrows and arrows[0].start() == 0:
            text = text[arrows[0].end() :]
            arrows = list(_ARROW.finditer(text.content))
        if not arrows:
            return text
        say = self.language.prose.say
        before = {*self.types(text[: arrows[0].start()])}
        if before & COMPARING and "MEASURE" not in before:
            text = text.replace(*arrows[0].span(), ", ")
            if not before & {"IF", "UNLESS", "ELSE"}:
                text = text.replace(0, 1, f"{say['if']} {text.content[0]}")
            arrows = list(_ARROW.finditer(text.content))
        for arrow in reversed(arrows):
            text = text.replace(*arrow.span(), say["then"])
        return text

    def figures(self, text: ScriptText) -> ScriptText:
        """The text with letters among digits read as digits, `#l7`, and with words that have
        digits in them read as those that they can only be: `p0int`. Digits by themselves are never
        changed."""
        for signs, meant in ((_WORD, self._with_letters), (_MIXED, self._with_digits)):
            for found in reversed(list(signs.finditer(text.content))):
                start, end = found.span()
                quoted = any(a < start < b for a, b in quotes(text.content))
                if quoted or found[0].lower() in self.names or (said := meant(found)) is None:
                    continue
                self._warn(text, start, end, said)
                text = text.replace(start, end, said)
        return text

    def _with_digits(self, found: re.Match[str]) -> str | None:
        named = _identified(self.language.lexicon).search(found.string[: found.start()])
        return None if named else found[0].translate(_DIGITS)

    def _with_letters(self, found: re.Match[str]) -> str | None:
        signs = [_LETTERS.get(s, s) if s.isdigit() else s for s in found[0].lower()]
        if 2 * sum(s.isalpha() for s in found[0]) <= len(signs):
            return None
        words = {"".join(word) for word in islice(product(*signs), _MOST_TRIED)} & self.known
        return words.pop() if len(words) == 1 else None

    def _warn(self, text: ScriptText, start: int, end: int, meant: str) -> None:
        said = text.content[start:end]
        if said.lower() != meant:
            message = f"read `{said}` as `{meant}`"
            self.diagnostics.warning("respelled", message, text.span(start, end))

    # ---- what makes no sense

    def not_understood(self, text: ScriptText, stumble: StumbleError) -> None:
        """Add the error of a sentence that makes no sense, at the words that make none, with what
        may stand there."""
        found = self.words(text)
        at = next((w for w in found if w.type in ("WORD", "CANNOT")), None)
        if at is None and stumble.at < len(found):
            at = found[stumble.at]
        hint = self._hint(text, at, found, stumble)
        if at is None:
            message = "the sentence is incomplete"
            self.diagnostics.error("unfinished", message, text.span(len(text.content)), hint)
            return
        said = text.content[at.start : at.end]
        message = f"Argo does not understand `{said}` here"
        if at.type == "CANNOT":
            message = f"`{said}` is not an action of the robot"
        self.diagnostics.error("not-understood", message, text.span(at.start, at.end), hint)

    def _hint(
        self, text: ScriptText, at: Word | None, found: list[Word], stumble: StumbleError
    ) -> str:
        parts = []
        if at is not None and at.type == "WORD":
            said = text.content[at.start : at.end]
            meant = candidates(said, self.known)
            if meant and said.lower() not in meant:
                choices = listed((f"`{word}`" for word in sorted(meant)[:3]), "or")
                parts.append(f"is {choices}{IS_MEANT}")
        if at is None or (stumble.at < len(found) and found[stumble.at] is at):
            before = tuple(word.type for word in found[: stumble.at])
            follow = self._may_follow(before)
            if follow:
                parts.append(f"possible here: {listed(follow, 'or')}")
        samples = self.language.prose.samples
        verb = next((w.type for w in found if w.type in samples), "MEASURE")
        parts.append(f"say, `{samples[verb]}`")
        return "; ".join(parts)

    def _may_follow(self, before: tuple[str, ...]) -> list[str]:
        """What the grammar accepts behind these words, in words of the language. Where an order may
        begin there is too much to be told."""
        accepted = self.grammar.accepted(before)
        if accepted.issuperset(VERBS[:4]):
            return []
        prose, lexicon = self.language.prose, self.language.lexicon
        shown = {type_: said for type_, said in prose.kinds.items() if type_ in accepted}
        for (type_, _), phrases in lexicon.phrases.items():
            if type_ in accepted and type_ not in _UNTOLD:
                shown.setdefault(type_, f"`{phrases[0]}`")
        return list(dict.fromkeys(shown.values()))[:_MOST_TOLD]


def _both(one: Lexicon) -> list[dict[Entry, list[str]]]:
    """The phrases of a language and of the other one."""
    return [one.phrases, *([] if one.other is None else [one.other.phrases])]


def _joints(lexicon: Lexicon, meaning: str) -> list[str]:
    return [said for phrases in _both(lexicon) for said in phrases["JOINT", meaning]]


@cache
def _contractions(phrases: str) -> list[tuple[re.Pattern[str], str]]:
    """Return patterns of short forms, each with its words."""
    pairs = [pair.split("=>") for pair in phrases.split("|")]
    apostrophe = [(short.strip().replace("'", "['’]"), full.strip()) for short, full in pairs]
    return [(re.compile(rf"\b{short}\b", re.IGNORECASE), full) for short, full in apostrophe]


@cache
def _signs(lexicon: Lexicon) -> frozenset[str]:
    """The signs in the phrases of a language and of the other one."""
    every = (said for phrases in _both(lexicon) for said in phrases.values())
    return frozenset('"'.join(phrase for said in every for phrase in said))


@cache
def _joint_at_end(lexicon: Lexicon) -> re.Pattern[str]:
    joints = either("|".join([*_joints(lexicon, "and"), *_joints(lexicon, "or")]))
    return re.compile(rf"(?<!\w)(?:{joints})\s*$", re.IGNORECASE)


@cache
def _identified(lexicon: Lexicon) -> re.Pattern[str]:
    """What has an identifier, such as valves, at the end of a text."""
    kinds = [
        phrase
        for phrases in _both(lexicon)
        for (type_, value), said in phrases.items()
        if type_ == "KIND" and value[0] is not Kind.CHECKPOINT
        for phrase in said
    ]
    return re.compile(rf"(?<!\w)(?:{either('|'.join(kinds))})\s+$", re.IGNORECASE)


def _is_amend(tree: Branch) -> bool:
    """Whether a sentence says nothing but a manner."""
    _, parts, _, _ = tree
    first = parts[0]
    if isinstance(first, int) or first[0] != "order":
        return False
    order = first[1][-1]
    return not isinstance(order, int) and order[0] == "amend"
