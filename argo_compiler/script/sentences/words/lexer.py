"""Cuts a sentence into the words of the grammar."""

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from argo_compiler.script.sentences.words.amounts import read_clock, read_glued
from argo_compiler.script.sentences.words.joints import joined
from argo_compiler.script.sentences.words.lexicon import Lexicon, folded
from argo_compiler.script.sentences.words.merging import merged, negated
from argo_compiler.script.sentences.words.numbers import Figure, compose, read_figure, split_number
from argo_compiler.script.sentences.words.unknown import UnknownError, UnknownValue
from argo_compiler.script.sentences.words.without_effect import with_effect, without_empty
from argo_compiler.script.sentences.words.word import VERBS, Word
from argo_compiler.script.sentences.words.word_order import arranged

_PIECE = re.compile(
    r"""(?P<STRING>"(?:[^"\\]|\\.)*"(?:\s*"(?:[^"\\]|\\.)*")*)
    |(?P<CLOCK>[0-9]{1,3}:[0-9]{2}(?::[0-9]{2})?(?![\d:]))
    |(?P<ORDINAL>[0-9]+(?:st|nd|rd|th)\b)
    |(?P<GLUED>[0-9]+(?:h|std)[0-9]{1,2}(?:m|min)?(?:[0-9]{1,2}s)?\b|[0-9]+(?:m|min)[0-9]{1,2}s\b)
    |(?P<NUMBER>[0-9]*[½¼¾]|[0-9]+(?:[.,'][0-9]+)*(?:e[+-]?[0-9]+\b)?)
    |(?P<IDENT>[^\W\d_]+-?[0-9]+\w*)
    |(?P<WORD>[^\W\d_](?:[\w'-]*\w)?)
    |(?P<SIGN><=|>=|\S)""",
    re.VERBOSE,
)
_QUOTED = re.compile(r"\"(?:[^\"\\]|\\.)*\"")
_GLUED_NUMBER = re.compile(r"([^\W\d_]{2,})([0-9]+)")
_SIGNS = {"(": "LPAR", ")": "RPAR", "[": "LSQB", "]": "RSQB", "-": "DASH", "=": "EQUAL"}
_JOINTS = {",": ",", ";": ";", ":": ":", "&": "and"}
_LONGEST = 60
"""letters of a number in one word"""
_NAMES = {("AREA", "NUMBER"), ("KIND", "IDENT"), ("KIND", "NUMBER"), ("AREA",), ("PLACE",)}
"""what is often put between quotation marks, and means the same without"""
_NAMING = frozenset(["STEP", "SHOWN_IN", "ABOUT", "LPAR_CALLED", "LSQB"])
_JOINING = frozenset(["JOINT", "TO", "DASH", "UPTO"])
_FILLED = frozenset(["NUMBER", "STRING"])
"""words that may have unknown figures"""
_PLACED = frozenset(["AT_END", "AT_BEGIN", "THERE", "INSTEAD"])
"""words that say where something stands in the script, or on the site"""

_ORDERING = frozenset(["FIRST", "AT_END", "AT_BEGIN"])
_RANKING = frozenset(["ORDINAL", "SEQUENCE", "COMES_NEXT", "HASTE"])
"""words that say of the order, unless another word stands behind them: `third party`"""


# A sentence is looked at several times: what it is, whether it makes sense, what it says.
@lru_cache(maxsize=8192)
def words(text: str, lexicon: Lexicon) -> list[Word]:
    """The words of `text`, with the joints between them told apart by what they join; in another
    language where far more of them are known in that one."""
    return words_of(text, lexicon)


def _unknown(words: list[Word]) -> int:
    return sum(word.type == "WORD" for word in words)


def words_of(
    text: str, lexicon: Lexicon, unknown: Mapping[int, UnknownValue] = MappingProxyType({})
) -> list[Word]:
    """As `words`; the figures that begin at these places are not known. Raises UnknownError if one
    of them is no number by itself."""
    pieces = _pieces(text)
    found = _looked_up(text, pieces, lexicon, _PLACED)
    strange = _unknown(found)
    if lexicon.other is not None and strange:
        other = _looked_up(text, pieces, lexicon.other, _PLACED)
        if 2 * _unknown(other) < strange:
            found, lexicon = other, lexicon.other
    return _put_together(found, lexicon, unknown)


def _put_together(
    found: list[Word], lexicon: Lexicon, unknown: Mapping[int, UnknownValue]
) -> list[Word]:
    found = with_effect(found)
    if unknown:
        if not unknown.keys() <= {word.start for word in found if word.type in _FILLED}:
            raise UnknownError
        found = [replace(word, value=unknown.get(word.start, word.value)) for word in found]
    found = merged(found)
    return joined(_goals(negated(found if lexicon.verbs_first else arranged(found))))


def _goals(words: list[Word]) -> list[Word]:
    """The words; `go from starting area 2` does not say where to, so that `from` makes no sense."""
    for i in range(1, len(words)):
        if words[i].type == "FROM" and words[i - 1].type in ("GO", "HOME"):
            words[i] = replace(words[i], type="STRAY")
    return words


def placed_words(text: str, lexicon: Lexicon) -> list[Word]:
    """Return the words of a sentence by which it has a place: `at the end`, `there`, and `first` at
    its very end, or at its beginning if nothing in it comes `then`."""
    whole = all_words(text, lexicon)
    found = without_empty(whole)
    ends = found[-1:] if found and found[-1].type == "ORDINAL" and found[-1].value == 1 else []
    return [word for word in found if word.type in _PLACED] + ends + _opening(whole, found)


def _opening(whole: list[Word], found: list[Word]) -> list[Word]:
    """Return the `first` with which a sentence says that it comes before all others."""
    first = [word for word in whole if word.type == "FIRST"][:1]
    if not first and len(found) > 1 and found[0].type == "ORDINAL" and found[0].value == 1:
        first = found[:1] if found[1].type in VERBS or found[1].type == "JOINT" else []
    if not first or any(w.type == "SEQUENCE" for w in whole if w.start > first[0].start):
        return []
    return first


def says_order(content: str, lexicon: Lexicon) -> bool:
    """Return True if a text may say in which order something is done: `first`, `3rd`, `then`; not
    of `third party` or `then R25`, where such a word belongs to what stands behind it."""
    words = all_words(content, lexicon)
    behind = [*(word.type for word in words[1:]), ""]
    return any(
        (word.type in _ORDERING and after != "WORD")
        or (word.type in _RANKING and after in ("", "SIGN", "COLON"))
        for word, after in zip(words, behind, strict=True)
    )


def all_words(text: str, lexicon: Lexicon) -> list[Word]:
    """Return the words of a sentence one by one, those without effect as well."""
    return _looked_up(text, _pieces(text), lexicon, frozenset())


_Pieces = tuple[list[re.Match[str]], list[str]]
"""words and signs of a text, and how the lexicon writes each"""


def _pieces(text: str) -> _Pieces:
    pieces = list(_PIECE.finditer(_lower(text)))
    return pieces, [folded(piece.group()) for piece in pieces]


def _looked_up(
    text: str, in_text: _Pieces, lexicon: Lexicon, left_out: frozenset[str]
) -> list[Word]:
    pieces, said = in_text
    apart: set[int] = set()
    found: list[Word] = []
    i = 0
    while i < len(pieces):
        if i in apart:
            i += 1
            continue
        phrase = lexicon.longest(said, i) if said[i] in lexicon.root.next else None
        if phrase is None:
            after = pieces[i + 1] if i + 1 < len(pieces) else None
            inner: list[Word] = []
            if pieces[i].lastgroup == "IDENT":
                inner = _numbered(pieces[i], lexicon)
            elif pieces[i].lastgroup == "STRING" and (after is None or after.group() != ":"):
                inner = [] if _is_name(found) else _unwrapped(pieces[i], text, lexicon)
            found += inner or [_plain(pieces[i], after, found, text, lexicon)]
            i += 1
            continue
        type_, value = phrase.entry
        if type_ not in left_out:
            if type_ == "KIND":
                value = _definite(value, said[i - 1] if i > 0 else "", lexicon)
            elif type_ == "UNIT_S" and _is_one(value, said, i, found, lexicon):
                type_ = "A_UNIT"
            end = pieces[i + phrase.length - 1].end()
            found.append(Word(type_, value, pieces[i].start(), end))
        apart.update(phrase.apart)
        i += phrase.length
    return found


def _numbered(piece: re.Match[str], lexicon: Lexicon) -> list[Word]:
    """The words of `LLG2` and `checkpoint4`, kinds and numbers; none of a name such as `R25`."""
    parts = _GLUED_NUMBER.fullmatch(piece.group())
    phrase = None if parts is None else lexicon.longest([folded(parts[1])], 0)
    if parts is None or phrase is None or phrase.entry[0] != "KIND":
        return []
    middle = piece.start() + len(parts[1])
    kind = Word("KIND", _definite(phrase.entry[1], "", lexicon), piece.start(), middle)
    return [kind, Word("NUMBER", read_figure(parts[2]), middle, piece.end())]


def _is_name(before: list[Word]) -> bool:
    """Whether what stands in quotation marks behind these words is a name, whatever it says."""
    before = without_empty(before[-4:])
    if not before:
        return False
    listed = len(before) > 1 and before[-2].type == "STRING"
    return before[-1].type in _NAMING or (listed and before[-1].type in _JOINING)


def _is_one(seconds: float, said: list[str], i: int, found: list[Word], lexicon: Lexicon) -> bool:
    """Whether a unit of time stands for one of it: `an hour`, `every minute`, `quarter-hour`."""
    if len(said[i]) > 3 and said[i].endswith(lexicon.plural_ending):
        return False
    counted = i > 0 and said[i - 1] in lexicon.passed_over and seconds > 1
    every = bool(found) and found[-1].type in ("EVERY", "ALL") and seconds > 1
    return counted or every or seconds in (900.0, 1800.0, 2700.0)


def _definite(kind: tuple[Any, bool | None], last: str, lexicon: Lexicon) -> tuple[Any, ...]:
    """A kind with whether an article says that it is known which; `die` is the article of
    several where the noun is the same for one."""
    plural = last == lexicon.plural_article if kind[1] is None and last else kind[1]
    return kind[0], plural or kind[1], last in lexicon.definite


def _unwrapped(piece: re.Match[str], text: str, lexicon: Lexicon) -> list[Word]:
    """The words in quotation marks that name a thing as it is named without: `"area 1"`."""
    start = piece.start() + 1
    inner = with_effect(all_words(text[start : piece.end() - 1], lexicon))
    types = tuple(word.type for word in inner)
    if types not in _NAMES:
        return []
    return [Word(w.type, w.value, w.start + start, w.end + start) for w in inner]


def _plain(
    piece: re.Match[str],
    after: re.Match[str] | None,
    before: list[Word],
    text: str,
    lexicon: Lexicon,
) -> Word:
    """The word of a piece that is in no lexicon."""
    said, kind = piece.group(), piece.lastgroup or "WORD"
    value: object = said
    match kind:
        case "SIGN":
            kind = "JOINT" if said in _JOINTS else _SIGNS.get(said, "SIGN")
            value = _JOINTS.get(said, said)
            if kind == "DASH" and after is not None and after.lastgroup == "NUMBER":
                last = before[-1].type if before else ""
                negative = last not in ("NUMBER", "IDENT") and after.start() == piece.end()
                kind = "MINUS" if negative else kind
        case "WORD":
            kind, value = _compound(said, lexicon)
        case "NUMBER":
            value = read_figure(said)
            kind = kind if value is not None else "BAD_NUMBER"
        case "ORDINAL":
            value = int(said[:-2])
        case "STRING":
            value = unquoted(text[piece.start() : piece.end()])
            kind = kind if value is not None else "BAD_STRING"
        case "CLOCK" | "GLUED":
            length = read_clock(said) if kind == "CLOCK" else read_glued(said)
            kind, value = (kind, said) if length is None else ("DURATION", length)
    return Word(kind, value, piece.start(), piece.end())


@lru_cache(maxsize=4096)
def _compound(said: str, lexicon: Lexicon) -> tuple[str, object]:
    """`zweihundertfünf` and `dreimal`; any other word is one that is not known."""
    head = folded(said)
    ending = lexicon.times_ending
    times = ending != "" and head.endswith(ending)
    parts = split_number(head.removesuffix(ending), lexicon.numerals)
    if parts and len(said) <= _LONGEST:
        number, n = compose(parts)
        if n == len(parts):
            return "TIMES" if times else "NUMBER", Figure(float(number))
    return "WORD", said


def unquoted(text: str) -> str | None:
    """The text that quoted pieces, one after the other, stand for; None if one is no JSON."""
    try:
        whole = "".join(str(json.loads(piece)) for piece in _QUOTED.findall(text))
        whole.encode()
    except ValueError:
        return None
    return whole


def _lower(text: str) -> str:
    """`text` in lower case, character by character: no position moves."""
    lower = text.lower()
    if len(lower) == len(text):
        return lower
    return "".join(c.lower() if len(c.lower()) == 1 else c for c in text)
