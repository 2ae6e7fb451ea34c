"""Cuts a sentence into the words of the grammar."""

import re
from collections.abc import Iterator
from typing import Any

from argo_compiler.script.syntax.words.lexicon import Entry, Lexicon, Node
from argo_compiler.script.syntax.words.numbers import read_figure
from argo_compiler.script.syntax.words.word import Word

_PIECE = re.compile(
    r"""(?P<STRING>"(?:[^"\\]|\\.)*")
    |(?P<CLOCK>[0-9]{1,3}:[0-9]{2}(?::[0-9]{2})?(?![\d:]))
    |(?P<ORD>[0-9]+(?:st|nd|rd|th)\b)
    |(?P<NUMBER>[0-9]+(?:[.,'][0-9]+)*(?:e[+-]?[0-9]+\b)?)
    |(?P<RATE>m\s*/\s*s\b|km\s*/\s*h\b)
    |(?P<IDENT>[^\W\d_]+-?[0-9]+\w*)
    |(?P<WORD>[^\W\d_](?:[\w'-]*\w)?)
    |(?P<SIGN><=|>=|\S)""",
    re.VERBOSE,
)
_JOINTS = {",": ",", ";": ";", ":": ":", "&": "and"}
_VERBS = frozenset(
    "MEASURE KEEP_MEASURING GO HOME START START_HERE PATROL WAIT PAUSE END ABORT GO_ON RECHARGE "
    "REPORT REPEAT DO_FOLLOWING ADD DELETE REPLACE MOVE JUMP RETRY DOCK DONE MEET".split()
)
_NOUNS = frozenset("KIND HASH IDENT STRING ALL IT THEM THIS OF VALUE".split())
_TESTS = frozenset("IS GREATER LESS AT_LEAST AT_MOST BETWEEN STATE NOT FAILS".split())
_PLACES = frozenset("FLOOR FLOOR_NAME ORDINAL AREA PLACE".split())
_EVENTS = frozenset(["EVENT", "BATTERY"])
_AMOUNTS = frozenset(["QUANTITY", "DURATION", "MINUS"])
_JOINED = {
    **dict.fromkeys(_NOUNS, "NOUN"),
    **dict.fromkeys(_TESTS, "TEST"),
    **dict.fromkeys(_PLACES, "PLACE"),
    **dict.fromkeys(_EVENTS, "EVENT"),
    **dict.fromkeys(_AMOUNTS, "AMOUNT"),
    "NUMBER": "NUMBER",
}
"""what a joint joins, by the word behind it"""
_SIGNS = {"(": "LPAR", ")": "RPAR", "[": "LSQB", "]": "RSQB", "-": "DASH", "=": "EQUAL"}


def words(text: str, lexicon: Lexicon) -> list[Word]:
    """The words of `text`, with the joints between them told apart by what they join."""
    return list(_joined(_merged(_looked_up(text.lower(), lexicon))))


def _looked_up(text: str, lexicon: Lexicon) -> list[Word]:
    pieces = [m for m in _PIECE.finditer(text)]
    found: list[Word] = []
    i = 0
    while i < len(pieces):
        piece = pieces[i]
        entry, n = _longest(pieces, i, lexicon.root)
        start, end = piece.start(), pieces[i + max(n, 1) - 1].end()
        if entry is not None:
            if entry[0] not in ("FILLER", "IDLE"):
                found.append(Word(entry[0], entry[1], start, end))
        elif piece.lastgroup == "NUMBER":
            found.append(Word("NUMBER", read_figure(piece.group()), start, end))
        elif piece.lastgroup == "SIGN":
            found.append(_sign(piece, found, pieces[i + 1] if i + 1 < len(pieces) else None))
        else:
            found.append(Word(piece.lastgroup or "WORD", piece.group(), start, end))
        i += max(n, 1)
    return found


def _sign(piece: re.Match[str], found: list[Word], after: re.Match[str] | None) -> Word:
    sign = piece.group()
    if sign in _JOINTS:
        return Word("JOINT", _JOINTS[sign], piece.start(), piece.end())
    kind = _SIGNS.get(sign, "SIGN")
    if kind == "DASH" and after is not None and after.lastgroup == "NUMBER":
        last = found[-1].type if found else ""
        if last not in ("NUMBER", "IDENT") and after.start() == piece.end():
            kind = "MINUS"
    return Word(kind, sign, piece.start(), piece.end())


def _longest(pieces: list[re.Match[str]], i: int, root: Node) -> tuple[Entry | None, int]:
    """The longest phrase from piece `i` on, articles within it passed over."""
    node, best, n = root, None, 0
    k = i
    while k < len(pieces):
        piece = pieces[k].group()
        step = node.next.get(piece)
        if step is None:
            if node is not root and piece in ("the", "a", "an"):
                k += 1
                continue
            break
        node = step
        k += 1
        if node.entry is not None:
            best, n = node.entry, k - i
    return best, n


def _merged(found: list[Word]) -> list[Word]:
    """Numbers with their units: durations, speeds, quantities, how often."""
    merged: list[Word] = []
    i = 0
    while i < len(found):
        word = found[i]
        after = found[i + 1] if i + 1 < len(found) else None
        if word.type in ("NUMBER", "TIMES", "HALF") and after is not None:
            kind: str | None = None
            value: Any = None
            if after.type == "UNIT_S":
                kind = "DURATION"
                value = (word.value.value if word.type == "NUMBER" else 0.5) * after.value
            elif after.type == "TIME_WORD":
                kind, value = "TIMES", word.value
            elif after.type == "RATE":
                kind, value = "SPEED", (word.value, after.value)
                if merged and merged[-1].type == "AT":
                    del merged[-1]
            elif after.type in ("WORD", "SIGN") and after.value in _UNITS:
                kind, value = "QUANTITY", (word.value, after.value)
            if kind is not None:
                merged.append(Word(kind, value, word.start, after.end))
                i += 2
                continue
        if word.type == "MEASURE" and after is not None and after.type in _RELATIONS:
            word = Word("IS", None, word.start, word.end)
        elif word.type == "IF" and found[0] is not word and merged[-1].type != "JOINT":
            word = Word("IF_ONLY", None, word.start, word.end)
        elif word.type in ("ON", "IN") and after is not None and after.type == "EVENT":
            word = Word("IF", None, word.start, word.end)
        merged.append(word)
        i += 1
    return merged


_RELATIONS = frozenset("GREATER LESS AT_LEAST AT_MOST BETWEEN".split())
_UNITS = frozenset(["bar", "psi", "mpa", "mbar", "kpa", "%", "°", "deg", "degrees", "pa", "percent"])


def _joined(found: list[Word]) -> Iterator[Word]:
    """The words with joints of the type that says what they join; others are kept in `before`."""
    joints: list[str] = []
    start = 0
    for word in found:
        if word.type == "JOINT":
            if not joints:
                start = word.start
            joints.append(word.value)
            continue
        said = " ".join(joints)
        if joints:
            kind = _joint(said, word)
            if kind:
                yield Word(kind, said, start, word.start)
        joints = []
        yield Word(word.type, word.value, word.start, word.end, said)


def _joint(said: str, word: Word) -> str | None:
    if word.type in _VERBS:
        return "OR_DO" if "or" in said else "NEXT"
    joined = _JOINED.get(word.type)
    if joined is None:
        return None
    if ":" in said:
        return "COLON"
    return f"{'OR' if 'or' in said else 'AND'}_{joined}"
