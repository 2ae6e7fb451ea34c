"""Words without effect, and the places of a sentence in which they have none.

An article belongs to what it names, `please` to an order, `also` to an order or a list. In any
other place, as in `the next valve` or `if it is a normal`, such a word may have a meaning: there it
is left in the sentence, and the grammar does not take it.
"""

from collections.abc import Sequence
from dataclasses import replace
from enum import Flag, auto
from itertools import takewhile

from argo_compiler.script.sentences.words.word import COMPARISONS, OPENINGS, VERBS, Word


class WordPlace(Flag):
    """Place of a word in a sentence, by the words beside it."""

    BEGIN = auto()
    """where a sentence, a clause or an item of a list begins"""
    INSIDE = auto()
    """anywhere but at the beginning of the sentence, where it asks: `does it have to check #4`"""
    END = auto()
    """where a clause ends that is no condition"""
    BEFORE_VERB = auto()
    AFTER_VERB = auto()
    BEFORE_NAME = auto()
    """before what can be named: no comparison, state or sign"""
    BEFORE_NUMBERED = auto()
    """where a clause begins, before a verb or a checkpoint with a number or a name"""
    AFTER_NOUN = auto()
    AFTER_COUNT = auto()
    """`two of them`"""
    AFTER_TIME = auto()
    """`10 Minuten lang`"""
    AFTER_FAILURE = auto()
    """`schlägt das fehl`"""
    AFTER_PLACE = auto()
    """in the name of a place: `gate A`"""
    BEFORE_LIMIT = auto()
    """before a condition, a count or a comparison"""


_CLAUSE = WordPlace.BEGIN | WordPlace.END | WordPlace.BEFORE_VERB | WordPlace.AFTER_VERB
PLACES = {
    "ARTICLE": WordPlace.BEFORE_NAME | WordPlace.AFTER_FAILURE | WordPlace.AFTER_PLACE,
    "SUBJECT": WordPlace.BEGIN | WordPlace.BEFORE_VERB | WordPlace.AFTER_VERB,
    "BIDDING": WordPlace.BEGIN | WordPlace.BEFORE_VERB | WordPlace.AFTER_VERB,
    "INVERTED": WordPlace.INSIDE,
    "COURTESY": _CLAUSE | WordPlace.AFTER_NOUN,
    "SEQUENCE": _CLAUSE,
    "FIRST": _CLAUSE,
    "COMES_NEXT": WordPlace.BEFORE_NUMBERED,
    "FOCUS": _CLAUSE | WordPlace.BEFORE_LIMIT,
    "ADDITION": _CLAUSE,
    "HASTE": _CLAUSE,
    "AMONG": WordPlace.AFTER_COUNT,
    "WHOLE_SITE": WordPlace.AFTER_NOUN,
    "STAYING": WordPlace.AFTER_VERB | WordPlace.END,
    "SINGLY": WordPlace.END,
    "CARE": _CLAUSE,
    "DAY": _CLAUSE | WordPlace.AFTER_NOUN,
    "THANKS": _CLAUSE,
    "LASTING": WordPlace.AFTER_TIME,
    "THITHER": _CLAUSE,
}
"""by terminal, the places in which its words have no effect"""
WITHOUT_EFFECT = frozenset(PLACES)
MISPLACED = "MISPLACED"
"""type of such a word in another place; its value is the terminal"""
HARMLESS = frozenset(["ARTICLE", "SUBJECT", "BIDDING", "COURTESY", "WHOLE_SITE", "THANKS"])
"""words that change nothing in another place either, where a proposal is made"""
LINKING = frozenset(["IN", "AT", "TO", "ON", "FROM", "FOR", "BY", "IS", "HASH"])
"""words that link others and mean nothing by themselves, where the grammar takes a sentence without
them as well"""
TOLD = frozenset(["FOCUS", "CARE", "DAY"])
"""words that a reader may mean something by, of which a warning tells that they have no effect"""

_BEGIN = OPENINGS | {
    *("", "JOINT", "SIGN", "DASH", "LPAR", "ELSE", "IN_ALL_OTHERS", "IN_ANY_CASE", "LAST_ROUND"),
    *("IT", "HE", "THEY", "BEFORE", "AFTER", "IF_TIME", "NOT", "SHOULD"),
}
_END = OPENINGS | {"", "JOINT", "SIGN", "RPAR", "DASH", "ELSE"}
_RELATIONS = COMPARISONS | {"EXACTLY", "OLDER", "OUTSIDE", "MORE_WORD"}
_NO_NAME = frozenset(["", "JOINT", "SIGN", "STATE", "NOT", "TIMES", "IS"]) | _RELATIONS | OPENINGS
_VERBAL = frozenset(
    [*VERBS, "BE_MEASURED", "IS", "BACK", "LEAVE_OUT", "KEEP_ORDER", "MAX_DURATION", "BACK_IN"]
)
_LABELS = frozenset(["NUMBER", "NUMBER_WORD", "IDENT", "STRING", "HASH"])
_NOUNS = _LABELS | {"KIND", "EVERYTHING", "FLOOR", "FLOOR_NAME", "AREA", "DOCK", "PLACE", "RPAR"}
_COUNTS = frozenset(["NUMBER", "NUMBER_WORD", "ALL", "BOTH", "EITHER", "NEITHER", "THEM", "EVERY"])
_TIMES = frozenset(["DURATION", "A_UNIT", "UNIT_S", "TIMES"])
_COUNTED = frozenset(
    [
        "KIND",
        "FLOOR",
        "AREA",
        "STEP",
        "UNIT",
        "UNIT_S",
        "NUMBER_WORD",
        "NUMBER",
        "TIME_WORD",
        "WORD",
        "DASH",
    ]
)
"""types of words behind a number of them"""
_AND = frozenset(["JOINT", "NEXT"])
_LIMITS = OPENINGS | _RELATIONS | {"TIMES", "MOST_TIMES", "MOST_TIME", "FOR", "BY"}


def with_effect(words: list[Word]) -> list[Word]:
    """Return the words without those that have no effect where they stand; such a word in another
    place becomes one that no grammar takes."""
    found: list[Word] = []
    for i, word in enumerate(words):
        if word.type not in WITHOUT_EFFECT:
            found.append(word)
        elif word.type == "SEQUENCE" and parts_list(words, i, found):
            found.append(replace(word, type="MEASURE"))
        elif not places_of(words, i, found) & PLACES[word.type]:
            found.append(replace(word, type=MISPLACED, value=word.type))
    return found


def left_out(words: list[Word]) -> list[Word]:
    """Return the words of a sentence that have no effect where they stand."""
    starts = {word.start for word in with_effect(words)}
    return [word for word in words if word.start not in starts]


def without_empty(words: Sequence[Word]) -> list[Word]:
    """Return the words of all other classes, in their order."""
    return [word for word in words if word.type not in WITHOUT_EFFECT]


def places_of(words: Sequence[Word], i: int, before: Sequence[Word]) -> WordPlace:
    """Return the places at which a word stands, after the words with effect before it."""
    last = before[-1].type if before else ""
    following = [word.type for word in words[i + 1 : i + 8] if word.type not in WITHOUT_EFFECT]
    next_ = following[0] if following else ""
    beside = words[i + 1].type if i + 1 < len(words) else ""
    found = WordPlace(0)
    if last == "NOT" and words[i].type not in HARMLESS:
        return found  # `don't just check #4`
    if last in _BEGIN:
        found |= WordPlace.BEGIN
    if before:
        found |= WordPlace.INSIDE
    if next_ in _END and not _in_condition(before):
        found |= WordPlace.END
    if next_ in _VERBAL:
        found |= WordPlace.BEFORE_VERB
    if last in _VERBAL and last != "IS":
        found |= WordPlace.AFTER_VERB
    stands_for_name = words[i].type == "ARTICLE" and _is_pronoun(words[i + 1 : i + 3])
    if (next_ not in _NO_NAME and not stands_for_name) or beside in WITHOUT_EFFECT - {"ARTICLE"}:
        found |= WordPlace.BEFORE_NAME
    numbered = following[:1] == ["KIND"] and following[1:2] and following[1] in _LABELS
    if last in _BEGIN and (next_ in _VERBAL | _LABELS | {"JOINT"} or numbered):
        found |= WordPlace.BEFORE_NUMBERED
    if last in _NOUNS:
        found |= WordPlace.AFTER_NOUN
    if last in _COUNTS and not (last in _LABELS and before[-2:][0].type in _AND):
        found |= WordPlace.AFTER_COUNT
    if last in _TIMES:
        found |= WordPlace.AFTER_TIME
    if last == "PLACE":
        found |= WordPlace.AFTER_PLACE
    if last == "ON_FAILURE":
        found |= WordPlace.AFTER_FAILURE
    if next_ in _LIMITS:
        found |= WordPlace.BEFORE_LIMIT
    return found


def parts_list(words: Sequence[Word], i: int, before: Sequence[Word]) -> bool:
    """Return True for `then` where an order begins: `#14, then #1 and #4 in any order`."""
    listed = before[-1:] and before[-1].type == "JOINT"
    verbs = [word.type for word in before if word.type in VERBS]
    if not listed or verbs[-1:] != ["MEASURE"] or _in_condition(before):
        return False
    behind = [word.type for word in without_empty(words[i + 1 :])]
    clause = list(takewhile(lambda type_: type_ not in VERBS, behind))
    return clause[:1] != [] and clause[0] in _NOUNS | {"ALL", "EVERY"} and "ANY_ORDER" in clause


def _is_pronoun(words: Sequence[Word]) -> bool:
    """Return True for a number in words that counts nothing: `the one after that`."""
    number = [word.type for word in words[:1]] == ["NUMBER_WORD"]
    return number and not (words[1:] and words[1].type in _COUNTED)


def _in_condition(before: Sequence[Word]) -> bool:
    """Return True if a condition begins in these words and no order behind it."""
    last = next((w.type for w in reversed(before) if w.type in OPENINGS or w.type in VERBS), "")
    return last in OPENINGS
