"""What stands around the sentences of a script: labels of fields, greetings, remarks, columns."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property

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
    def cue(self) -> re.Pattern[str]:
        """The pattern of the phrases of all cues, in lower case."""
        return re.compile(rf"(?<![\w-])(?:{either('|'.join(self.cues.values()))})")

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


class Beginnings:
    """Phrases with which a text may begin, in any case. A pattern of hundreds of phrases takes long
    to make, so there is one for each first word, made when a text begins with it."""

    def __init__(self, phrases: str) -> None:
        self._said: dict[str, list[str]] = {}
        for phrase in expand(phrases):
            self._said.setdefault(_first_letters(phrase), []).append(phrase)
        self._made: dict[tuple[str, bool], re.Pattern[str]] = {}

    def search(self, text: str) -> bool:
        """Return True if one of the phrases is somewhere in a text."""
        return any(self.match(text, word.start()) for word in _WORD_START.finditer(text))

    def match(self, text: str, at: int = 0) -> re.Match[str] | None:
        """Return the longest phrase that begins at a place of the text, and that does not end
        within a word; None if there is none."""
        first = _first_letters(text, at)
        behind = at + len(first)
        # A letter that is not ASCII may be one of a phrase's letters, in capitals.
        key = first, text[behind : behind + 1].isascii()
        if key[1] and first not in self._said:
            return None
        if key not in self._made:
            begun = self._said if not key[1] else (first,)
            said = [p for start in begun if start.startswith(first) for p in self._said[start]]
            self._made[key] = _beginning(said)
        return self._made[key].match(text, at)


@cache
def begins(phrases: str) -> Beginnings:
    """What begins with one of the phrases."""
    return Beginnings(phrases)


_IN_BRACKETS = re.compile(r"\s*[(\[]\s*[^\W\d_][^()\[\]]*[)\]]$|\s*[(\[][%°][)\]]$")
"""such as a unit, at the end of a heading"""
_FIRST_LETTERS = re.compile("[A-Za-z]*")
_WORD_START = re.compile(r"(?<![\w-])\w")


def _first_letters(text: str, at: int = 0) -> str:
    found = _FIRST_LETTERS.match(text, at)
    return found.group().lower() if found else ""


def _beginning(phrases: list[str]) -> re.Pattern[str]:
    return re.compile(rf"(?:{either('|'.join(phrases))})(?![\w-])", re.IGNORECASE)


@cache
def cue_pattern(name: str, phrases: str) -> re.Pattern[str]:
    """Return the pattern of the phrases of a cue."""
    return re.compile(rf"(?<![\w-])(?P<{name}>{either(phrases)})(?![\w-])", re.IGNORECASE)
