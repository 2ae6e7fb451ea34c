"""The word order of German: puts a clause's verb before what it is said of, as the grammar has it.

`Kontrollpunkt 3 prüfen, danach zur Dockingstation fahren` becomes `prüfen Kontrollpunkt 3, danach
fahren zur Dockingstation`. Where it is not clear which words belong to a verb they stay where they
are, and the grammar does not take them.
"""

from dataclasses import replace
from itertools import takewhile

from argo_compiler.script.sentences.words.word import COMPARISONS, OPENINGS, VERBS, Word

_MOVED = frozenset(VERBS) - {"DOCK", "DONE", "MEET", "FROM"} | {"BACK"}
_RELATIONS = COMPARISONS | {"FROM", "OLDER", "OUTSIDE"}
_AMOUNTS = frozenset(["NUMBER", "QUANTITY", "DURATION"])
_ASKED = frozenset(["STATE", "OCCURS", "FAILS", "EVENT", "IS"])
_PREDICATES = _RELATIONS | {"NOT", "STATE", "FAILS", "NUMBER", "QUANTITY", "MINUS"}
_NAMED = frozenset(["KIND", "HASH", "IDENT", "STRING", "ALL", "NUMBER", "THIS", "EVERY"])
_LABELS = frozenset(["NUMBER", "IDENT", "HASH"])
_FLOORS = ("FLOOR", "FLOOR_NAME")
_SPOTS = frozenset(["AREA", "DOCK", "PLACE", "FLOOR", "FLOOR_NAME", "ORDINAL", "STRING", "WORD"])


def arranged(words: list[Word]) -> list[Word]:
    """The words in the order of the grammar, those of two senses told apart."""
    words = _counted_from_ground(words)
    told = [w for i in range(len(words)) for w in _told(words, i)]
    found = _verbs_first(_compared(told))
    return [w for i, w in enumerate(found) if w.type != "IS" or _is_needed(found, i)]


def _counted_from_ground(words: list[Word]) -> list[Word]:
    """The words, `1. Obergeschoss` as the second floor; floors are counted from the bottom."""
    found: list[Word] = []
    for word in words:
        if word.type == "UPPER_FLOOR":
            dotted = [w.type for w in found[-2:]] == ["NUMBER", "SIGN"] and found[-1].value == "."
            if dotted and found[-2].value.whole is not None:
                number = found[-2]
                found[-2:] = [Word("ORDINAL", number.value.whole + 1, number.start, number.end)]
            elif found and found[-1].type == "ORDINAL":
                found[-1] = replace(found[-1], value=found[-1].value + 1)
            word = replace(word, type="FLOOR", value=False)
        found.append(word)
    return found


# ---- words of two senses


def _told(words: list[Word], i: int) -> list[Word]:
    """A word by what stands beside it; none if it says nothing there."""
    word = words[i]
    last = words[i - 1].type if i > 0 else ""
    after = words[i + 1].type if i + 1 < len(words) else ""
    match word.type:
        case "ALL" if after == "DURATION":
            return [replace(word, type="EVERY")]
        case "UNTIL" if after in ("NUMBER", "HASH", "IDENT", "QUANTITY", "MINUS"):
            return [replace(word, type="TO")]
        case "AFTER" if after in _SPOTS - {"STRING", "WORD"}:
            return [replace(word, type="TO")]
        case "AT" if after == "EVENT" or (
            after in ("VALUE", "SHOWN", "BATTERY") and _then(words, i + 2) in _RELATIONS
        ):
            return [replace(word, type="IF")]
        case "BE_MEASURED" if last in ("", "JOINT", *_FLOORS) and after in _NAMED:
            return [replace(word, type="MEASURE")]  # `danach wird Ventil R12 geprüft`
        case "MEASURE" if after == "NOT":
            return [replace(word, type="SPARE")]
        case "NOT" if last == "MEASURE":
            return []
        case "ON" if after == "PERSON" and _waits(words, i):
            return [replace(word, type="FOR")]
        case "IF" | "IF_ONLY" if after == "EVENT" and _waits(words, i):
            return [replace(word, type="FOR")]
        case "IS" if last == "" and after not in _PREDICATES:
            return [replace(word, type="IF")]
        case "TOTAL" if after == "TIMES":
            return [words[i + 1], word]
        case "TIMES" if last == "TOTAL":
            return []
        case "TO" if after in _MOVED:
            return []
        case "BY" if after == "STEP" and last in ("GO_ON", "JUMP"):
            return []
        case "GO_ON" | "GO" if after == "BY" and _then(words, i + 2) == "STEP":
            return [replace(word, type="JUMP")]
        case "SHOWN" if after in _NAMED - {"NUMBER", "HASH"}:
            return [replace(word, type="OF")]
        case "SHOWN" if after not in _NAMED:
            return [replace(word, type="VALUE")]
        case "NUMBER" if after == "SIGN" and _is_ordinal(words, i):
            return [Word("ORDINAL", word.value.whole, word.start, word.end)]
        case "SIGN" if last == "NUMBER" and _is_ordinal(words, i - 1):
            return []
        case "HE" if last in OPENINGS or after in ("NOT", *_RELATIONS, "STATE", "FAILS"):
            return [replace(word, type="IT")]
        case "HE":
            return []
        case "CAN" if last in ("", "JOINT", "ELSE") and _denied(words, i):
            return [replace(word, type="IF")]
        case "CAN":
            return []
        case "SPARE" if any(w.type == "CAN" and _denied(words, k) for k, w in enumerate(words[:i])):
            return [replace(word, type="FAILS")]
        case "ON_FAILURE":
            return [replace(word, type="IF"), replace(word, type="FAILS")]
        case "THEM" if after == "KIND" and _then(words, i + 2) in _LABELS:
            return []
        case "THEY":
            return [replace(word, type="THEM", value="or one")]
    return [word]


def _then(words: list[Word], i: int) -> str:
    return words[i].type if i < len(words) else ""


def _denied(words: list[Word], i: int) -> bool:
    """`Lässt sich Manometer 2 nicht ablesen, ...` is a condition."""
    clause = list(takewhile(lambda word: word.type != "JOINT", words[i:]))
    return clause[-1].type == "SPARE"


def _waits(words: list[Word], i: int) -> bool:
    """`warte auf Entwarnung`, `auf Entwarnung warten`"""
    return (i > 0 and words[i - 1].type == "WAIT") or _then(words, i + 2) == "WAIT"


def _is_ordinal(words: list[Word], i: int) -> bool:
    """`3. Stock`, `1. und 2. Stock`"""
    while _then(words, i) == "NUMBER" and _then(words, i + 1) == "SIGN":
        if words[i + 1].value != "." or words[i].value.whole is None:
            return False
        if _then(words, i + 2) == "FLOOR":
            return True
        if _then(words, i + 2) != "JOINT":
            return False
        i += 3
    return False


# ---- conditions


def _compared(words: list[Word]) -> list[Word]:
    """`5 bar übersteigt`, `5 bar oder mehr beträgt`: the relation before the amount."""
    found: list[Word] = []
    for i, word in enumerate(words):
        behind = word.type in ("GREATER", "LESS") and _then(words, i + 1) not in (
            *_AMOUNTS,
            "MINUS",
        )
        if behind and found and found[-1].type in ("NUMBER", "QUANTITY"):
            at = len(found) - (2 if len(found) > 1 and found[-2].type == "MINUS" else 1)
            found.insert(at, word)
        elif word.type == "IS" and len(found) > 1 and found[-1].type in ("OR_MORE", "OR_LESS"):
            found.insert(len(found) - 2, word)
        else:
            found.append(word)
    return found


def _is_needed(words: list[Word], i: int) -> bool:
    """Whether `ist` stands before what it says; at the end of a condition it says nothing."""
    if _then(words, i + 1) in _PREDICATES or i == 0:
        return True
    asks = any(word.type in OPENINGS for word in words[:i])
    return not asks or words[i - 1].type not in _ASKED | _AMOUNTS


# ---- verbs


def _verbs_first(words: list[Word]) -> list[Word]:
    found: list[Word] = []
    clause = 0
    moved = first = True
    for i, word in enumerate(words):
        if word.type not in _MOVED:
            found.append(word)
            continue
        head = _head(found, clause, moved, first)
        if head is not None and head < len(found):
            moved = True
        else:
            head, moved = len(found), False
        if word.type == "BACK":
            word = replace(word, type="GO" if _has_goal(words, i, found[head:]) else "HOME")
        found.insert(head, word)
        clause, first = len(found), False
    return found


def _head(found: list[Word], clause: int, moved: bool, first: bool) -> int | None:
    """Where the clause begins whose verb comes next; None if that is not clear."""
    start = clause
    for i in range(clause, len(found)):
        if found[i].type in ("ELSE", "IN_ANY_CASE"):
            start = i + 1
    named = _then(found, start) == "STRING" and _then(found, start + 1) == "JOINT"
    if named and found[start + 1].value == ":":
        start += 2
    asked = _asked(found, start)
    if asked is not None:
        start = asked + 1
        joints = [i for i in range(start, len(found)) if found[i].type == "JOINT"]
        start = joints[0] if joints else start
    elif found[clause:start] or first or moved:
        pass
    else:
        joints = [i for i in range(start, len(found)) if found[i].type == "JOINT"]
        if found and found[-1].type == "JOINT":
            return len(found)
        if len(joints) != 1:
            return None
        start = joints[0]
    if found and found[-1].type == "JOINT":
        return len(found)
    while _then(found, start) == "JOINT":
        start += 1
    return start


def _asked(found: list[Word], start: int) -> int | None:
    """The last word of the condition that stands before a verb and is not what the verb waits
    for."""
    opening = ""
    last: int | None = None
    for i in range(start, len(found)):
        type_ = found[i].type
        if type_ in (*OPENINGS, "FOR"):
            opening = type_
        if not opening or opening == "FOR":
            continue
        between = i > 1 and found[i - 1].type in ("JOINT", "TO") and found[i - 2].type in _AMOUNTS
        compared = i > 0 and found[i - 1].type in (*_RELATIONS, "MINUS")
        if type_ in _ASKED or (type_ in _AMOUNTS and (compared or (between and last == i - 2))):
            last = i
    if opening == "UNTIL" and last == len(found) - 1:
        return None
    return last


def _has_goal(words: list[Word], i: int, before: list[Word]) -> bool:
    """Whether a place is said to go back to: before the verb, or behind it in its clause."""
    if any(word.type in _SPOTS for word in before):
        return True
    for word in words[i + 1 :]:
        if word.type in _MOVED or word.type in ("JOINT", *OPENINGS):
            return False
        if word.type in _SPOTS:
            return True
    return False
