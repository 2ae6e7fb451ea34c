"""Cuts a sentence into the words of the grammar."""

import json
import re

from argo_compiler.script.syntax.words.joints import joined
from argo_compiler.script.syntax.words.lengths import read_clock, read_glued
from argo_compiler.script.syntax.words.lexicon import Entry, Lexicon, Node
from argo_compiler.script.syntax.words.merging import merged
from argo_compiler.script.syntax.words.numbers import read_figure
from argo_compiler.script.syntax.words.word import Word

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
_SIGNS = {"(": "LPAR", ")": "RPAR", "[": "LSQB", "]": "RSQB", "-": "DASH", "=": "EQUAL"}
_JOINTS = {",": ",", ";": ";", ":": ":", "&": "and"}
_PASSED_OVER = frozenset(["the", "a", "an", "straight", "directly", "then", "please", "also"])
"""within a phrase"""
_NAMES = {("AREA", "NUMBER"), ("KIND", "IDENT"), ("KIND", "NUMBER"), ("AREA",), ("PLACE",)}
"""what is often put between quotation marks, and means the same without"""
_NAMING = frozenset(["STEP", "SHOWN_IN", "ABOUT", "LPAR_CALLED", "LSQB"])
_JOINING = frozenset(["JOINT", "TO", "DASH", "UPTO"])
_UNSAID = frozenset(["FILLER", "IDLE"])


def words(text: str, lexicon: Lexicon) -> list[Word]:
    """The words of `text`, with the joints between them told apart by what they join."""
    return joined(merged(_looked_up(text, lexicon)))


def _looked_up(text: str, lexicon: Lexicon) -> list[Word]:
    pieces = list(_PIECE.finditer(_lower(text)))
    found: list[Word] = []
    i = 0
    while i < len(pieces):
        entry, n = _longest(pieces, i, lexicon.root)
        if entry is None and pieces[i].lastgroup == "STRING":
            inner = [] if _is_name(found) else _unwrapped(pieces[i], text, lexicon)
            if inner and not (i + 1 < len(pieces) and pieces[i + 1].group() == ":"):
                found += inner
                i += 1
                continue
        if entry is None:
            after = pieces[i + 1] if i + 1 < len(pieces) else None
            found.append(_plain(pieces[i], after, found[-1].type if found else "", text))
            i += 1
            continue
        if entry[0] not in _UNSAID:
            start, end = pieces[i].start(), pieces[i + n - 1].end()
            value = entry[1]
            if entry[0] == "KIND":
                value = (*value, i > 0 and pieces[i - 1].group() == "the")
            found.append(Word(entry[0], value, start, end))
        i += n
    return found


def _is_name(before: list[Word]) -> bool:
    """Whether what stands in quotation marks behind these words is a name, whatever it says."""
    if not before:
        return False
    listed = len(before) > 1 and before[-2].type == "STRING"
    return before[-1].type in _NAMING or (listed and before[-1].type in _JOINING)


def _unwrapped(piece: re.Match[str], text: str, lexicon: Lexicon) -> list[Word]:
    """The words in quotation marks that name a thing as it is named without: `"area 1"`."""
    start = piece.start() + 1
    inner = _looked_up(text[start : piece.end() - 1], lexicon)
    types = tuple(word.type for word in inner)
    if types not in _NAMES:
        return []
    return [Word(w.type, w.value, w.start + start, w.end + start) for w in inner]


def _longest(pieces: list[re.Match[str]], i: int, root: Node) -> tuple[Entry | None, int]:
    """The longest phrase from piece `i` on, and how many pieces it takes."""
    node, best, n = root, None, 0
    for k in range(i, len(pieces)):
        piece = pieces[k].group()
        step = node.next.get(piece)
        if step is None:
            if node is root or piece not in _PASSED_OVER:
                break
            continue
        node = step
        if node.entry is not None:
            best, n = node.entry, k - i + 1
    return best, n


def _plain(piece: re.Match[str], after: re.Match[str] | None, last: str, text: str) -> Word:
    """The word of a piece that is in no lexicon."""
    said, kind = piece.group(), piece.lastgroup or "WORD"
    value: object = said
    if kind == "NUMBER":
        value = read_figure(said)
        kind = kind if value is not None else "BAD_NUMBER"
    elif kind == "ORDINAL":
        value = int(said[:-2])
    elif kind == "STRING":
        value = unquoted(text[piece.start() : piece.end()])
        kind = kind if value is not None else "BAD_STRING"
    elif kind == "CLOCK":
        length = read_clock(said)
        kind, value = ("CLOCK", said) if length is None else ("DURATION", length)
    elif kind == "GLUED":
        length = read_glued(said)
        kind, value = ("GLUED", said) if length is None else ("DURATION", length)
    elif kind == "SIGN":
        kind = "JOINT" if said in _JOINTS else _SIGNS.get(said, "SIGN")
        value = _JOINTS.get(said, said)
        if kind == "DASH" and after is not None and after.lastgroup == "NUMBER":
            negative = last not in ("NUMBER", "IDENT") and after.start() == piece.end()
            kind = "MINUS" if negative else kind
    return Word(kind, value, piece.start(), piece.end())


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
    if text.isascii():
        return text.lower()
    return "".join(c.lower() if len(c.lower()) == 1 else c for c in text)
