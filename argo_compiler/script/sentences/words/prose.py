"""What stands around the sentences of a script: labels of fields, greetings, remarks, columns."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import NamedTuple

from argo_compiler.script.sentences.words.lexicon import Phrases, expand


@dataclass(frozen=True)
class Prose:
    """The phrases of a language that no sentence has. Bars separate phrases, as in a lexicon."""

    labels: Mapping[str, str]
    """of the header's fields, by the field's name; the first is the one that is shown"""
    values: Phrases
    """by field and meaning, what may stand behind its label"""
    around_areas: str
    """words around a starting area that say no more than that it is one"""
    columns: Mapping[str, str]
    """the headings of a table's columns, by what they hold"""
    roles: Mapping[str, str]
    """the headings of the columns of sheets that people fill in, by what they hold"""
    form: Mapping[str, str]
    """words of such sheets: for furniture, positions of valves, and what is left out"""
    ranks: Mapping[str, str]
    """words for a priority, by the number that they stand for"""
    highest: str
    """words behind a number that is the highest priority"""
    lowest: str
    yes: str
    greeting: str
    closing: str
    remark: str
    """labels of remarks"""
    small_talk: str
    """how sentences begin that ask for nothing"""
    reason: str
    """how clauses begin that ask for nothing"""
    occasion: str
    """how a sentence begins that says what it is for, or when"""
    section: str
    """words of headings that may stand before a sentence: `Changes of 14 May: ...`"""
    listing: str
    """words that say that a list follows: `check these valves:`"""
    counted: str
    """verbs that may be nouns as well, which titles number"""
    preposition: str
    """words behind which a title may have an article"""
    foremost: str
    """words for the first and the last place in the order"""
    determiner: str
    """words that begin the object of a verb"""
    page: str
    """words before the number of a page"""
    around_reactions: str
    """words of a heading that says no more than that what follows always holds"""
    explicit_title: str
    headline_preposition: str
    """words before a checkpoint in a title"""
    left_open: str
    """how a sentence begins that leaves the starting areas to the preparation"""
    sheet: str
    """further words of sheets, by which cut ones are put together"""
    no: str
    say: Mapping[str, str]
    """words that a table's columns stand for"""
    cues: Mapping[str, str]
    """words by which a line is proposed that the grammar does not take, by what they show"""
    contractions: str
    """short forms with an apostrophe, each with its words: `it's => it is`"""
    paraphrases: str
    """phrases that a proposal replaces by others which the grammar takes: `is not open => is below
    80 degrees`; `<n>` is an amount, `<k>` a word, `<x>` and `<y>` are any words"""
    samples: Mapping[str, str]
    """a sentence for each verb"""
    kinds: Mapping[str, str]
    """what a terminal stands for that has no phrases"""

    @cached_property
    def label(self) -> re.Pattern[str]:
        """A field's label with its colon; the group that matched is the field's name."""
        names = (f"(?P<{name}>{_key(text)})" for name, text in self.labels.items())
        return re.compile(rf"(?<![\w-])(?:{'|'.join(names)})\s*:", re.IGNORECASE)

    @cached_property
    def label_words(self) -> frozenset[str]:
        """All words of labels."""
        said = (phrase for text in self.labels.values() for phrase in expand(text))
        return frozenset(word for phrase in said for word in phrase.split())

    @cached_property
    def words(self) -> frozenset[str]:
        """All words that stand around sentences."""
        others = (self.around_areas, self.page, self.preposition, self.determiner, self.sheet)
        said = (word for text in others for phrase in expand(text) for word in phrase.split())
        return self.label_words.union(said)

    @cached_property
    def shown_labels(self) -> tuple[str, ...]:
        """The labels as they are told to people, without those that have no effect."""
        texts = (text for name, text in self.labels.items() if name != "nothing")
        return tuple(expand(text)[0].capitalize() for text in texts)

    @cached_property
    def meanings(self) -> dict[tuple[str, str], object]:
        """What a value in lower case means, by field and value."""
        return {
            (name, phrase): meaning
            for (name, meaning), text in self.values.items()
            for phrase in expand(text)
        }

    def column(self, heading: str) -> str | None:
        """What a table's column with this heading holds."""
        return self._columns.get(" ".join(heading.lower().strip(" .:*_").split()))

    @cached_property
    def _columns(self) -> dict[str, str]:
        columns = reversed(list(self.columns.items()))  # of two alike the first counts
        return {said: name for name, text in columns for said in expand(text)}

    def role(self, heading: str) -> str | None:
        """What the column of a sheet with this heading holds; it may have a unit in brackets, or be
        in two languages."""
        said = " ".join(heading.lower().strip(" .:*_").split())
        if said in self._roles:
            return self._roles[said]
        parts = [part.strip(" .:") for part in _IN_BRACKETS.sub("", said).split("/")]
        roles = [self._roles.get(part) for part in parts]
        return roles[0] if all(roles) else None

    def role_by_last_words(self, heading: str) -> str | None:
        """What a column holds by the end of its heading, `Reading as found`; only for a line that
        is known to have headings."""
        words = " ".join(_IN_BRACKETS.sub("", heading.lower()).split()).strip(" .:*_").split()
        ends = (" ".join(words[i:]) for i in range(len(words)))
        return next((self._roles[end] for end in ends if end in self._roles), None)

    @cached_property
    def _roles(self) -> dict[str, str]:
        roles = reversed(list(self.roles.items()))
        return {said.strip(" ."): name for name, text in roles for said in expand(text)}

    def rank(self, said: str) -> str | None:
        """The priority that a word such as `high` stands for."""
        return next((n for n, text in self.ranks.items() if said.lower() in expand(text)), None)

    def is_highest(self, said: str) -> bool | None:
        """Whether words such as `= highest` or `is the lowest` stand for the highest of all; None
        if they say something else."""
        words = " ".join(re.findall(r"\w+", said.lower()))
        if words in expand(self.highest):
            return True
        return False if words in expand(self.lowest) else None


def either(text: str) -> str:
    """A pattern of one of the phrases, the longest that fits."""
    longest_first = sorted(sorted(set(expand(text))), key=len, reverse=True)
    return "|".join(re.escape(phrase).replace(r"\ ", r"\s+") for phrase in longest_first)


def _key(text: str) -> str:
    """A pattern of one of the phrases, also as the key of a data file: `max_time`."""
    return either(text).replace(r"\s+", r"[\s_]+")


class PhrasePattern:
    """Phrases in any case that stand in a text, and neither begin nor end within a word; of several
    the longest. To be used as a pattern of `re`.

    A pattern of hundreds of phrases takes long to make, and long to search for. So there is one for
    each first word, made when a text has this word.
    """

    def __init__(self, phrases: str) -> None:
        self._phrases = expand(phrases)
        self._begun: dict[str, list[str]] = {}
        for phrase in self._phrases:
            self._begun.setdefault(_first_letters(phrase), []).append(phrase)
        self._first = frozenset(self._begun)
        self._made: dict[str, re.Pattern[str]] = {}

    @cached_property
    def whole(self) -> re.Pattern[str]:
        """The pattern of all the phrases."""
        return _pattern_of(self._phrases)

    @property
    def pattern(self) -> str:
        """The text of the pattern of all the phrases."""
        return self.whole.pattern

    def match(self, text: str, at: int = 0) -> re.Match[str] | None:
        """Return the phrase that begins at a place of a text; None if there is none."""
        pattern = self._beginning(text, at)
        return None if pattern is None else pattern.match(text, at)

    def fullmatch(self, text: str) -> re.Match[str] | None:
        """Return the phrase that is all of a text; None if it is none."""
        pattern = self._beginning(text, 0)
        return None if pattern is None else pattern.fullmatch(text)

    def search(self, text: str, at: int = 0) -> re.Match[str] | None:
        """Return the first phrase in a text, from a place on; None if there is none."""
        return next(self.finditer(text, at), None)

    def finditer(self, text: str, at: int = 0) -> Iterator[re.Match[str]]:
        """Return the phrases in a text, from a place on."""
        words = _words(text)
        if words is None:
            return self.whole.finditer(text, at)
        return iter(()) if self._first.isdisjoint(words.letters) else self._found(text, words, at)

    def sub(self, by: str, text: str) -> str:
        """Return a text with another one in place of each phrase."""
        return text if self.search(text) is None else self.whole.sub(by, text)

    def _found(self, text: str, words: "_Words", end: int) -> Iterator[re.Match[str]]:
        for place, letters in words.places:
            if place >= end and letters in self._first:
                found = self._begun_with(letters).match(text, place)
                if found is not None:
                    end = found.end()
                    yield found

    def _beginning(self, text: str, at: int) -> re.Pattern[str] | None:
        if not text.isascii() and _ODD.search(text):
            return self.whole
        letters = _first_letters(text, at)
        return self._begun_with(letters) if letters in self._first else None

    def _begun_with(self, letters: str) -> re.Pattern[str]:
        pattern = self._made.get(letters)
        if pattern is None:
            pattern = self._made[letters] = _pattern_of(self._begun[letters])
        return pattern


class _Words(NamedTuple):
    """Places at which the words and signs of a text begin."""

    places: tuple[tuple[int, str], ...]
    """each with the letters of ASCII that it begins with, in lower case"""
    letters: frozenset[str]


_FIRST_LETTERS = re.compile("[A-Za-z]*")
_WORD = re.compile(r"(?<![\w-])(?:([A-Za-z]+)|\S)")
_ODD = re.compile("[\u0130\u0131\u017f\u212a]")
"""letters that are letters of ASCII in any case"""


@lru_cache(maxsize=512)
def _words(text: str) -> _Words | None:
    """Return the words of a text; None if it has odd letters."""
    if not text.isascii() and _ODD.search(text):
        return None
    places = tuple([(word.start(), (word[1] or "").lower()) for word in _WORD.finditer(text)])
    return _Words(places, frozenset(letters for _, letters in places))


def _first_letters(text: str, at: int = 0) -> str:
    found = _FIRST_LETTERS.match(text, at)
    return found[0].lower() if found else ""


def _pattern_of(phrases: Iterable[str]) -> re.Pattern[str]:
    return re.compile(rf"(?<![\w-])(?:{either('|'.join(phrases))})(?![\w-])", re.IGNORECASE)


@cache
def phrase_pattern(phrases: str) -> PhrasePattern:
    """Return the pattern of the phrases that a text lists, with bars between them."""
    return PhrasePattern(phrases)


_IN_BRACKETS = re.compile(r"\s*[(\[]\s*[^\W\d_][^()\[\]]*[)\]]$|\s*[(\[][%°][)\]]$")
"""such as a unit, at the end of a heading"""
