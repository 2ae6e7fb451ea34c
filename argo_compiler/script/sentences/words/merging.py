"""Puts words together that are one, such as numbers in words, and tells by its neighbours what a
word of two senses means, and what a negation belongs to."""

from dataclasses import replace

from argo_compiler.script.sentences.words.amounts import Length, counted, hours_and, limited, total
from argo_compiler.script.sentences.words.numbers import Figure, compose
from argo_compiler.script.sentences.words.word import COMPARISONS, OPENINGS, VERBS, Word

_BEYOND = {"OR_MORE": "GREATER", "OR_LESS": "LESS"}
_RELATIONS = COMPARISONS | {"EXACTLY"}
_ASKED_OF = frozenset(
    ["EVENT", "BATTERY", "KIND", "HASH", "OF", "IT", "VALUE", "THIS", "THEM", "TOO_LATE"]
)
"""what begins the subject of a condition"""
_VALUES = _RELATIONS | {"QUANTITY"}
_SAID = _RELATIONS | {"IS", "NOT", "STATE", "FAILS"}
"""what begins that which a condition says of its subject"""
_EARLY = frozenset(["MEASURE", "GO", "PATROL"])
"""verbs, behind which `optionally` may stand"""
_AMOUNTS = _RELATIONS | {"NUMBER", "QUANTITY"}
_BEHIND_BETWEEN = ("JOINT", "SIGN", "RPAR", "WAIT", "COLON")
_OPENING = frozenset(["JOINT", "IN_ANY_CASE", "BEFORE", "AFTER", "ELSE", "IN_ALL_OTHERS"])
"""what a sentence or a clause may begin behind"""
_BETWEEN_FLOORS = ("JOINT", "ORDINAL", "ON", "IN")
_UPTO = ("TO", "UNTIL")
"""`1 to 4`, `1 bis 4`"""
_LABELS = frozenset(["NUMBER", "NUMBER_WORD", "IDENT", "STRING"])
_LISTING = frozenset(["JOINT", "TO", "UNTIL", "DASH", "UPTO"])
_ADDING = frozenset(["and", ","])
"""joints between the parts of a length of time: `an hour and a half`"""
_PREDICATES = COMPARISONS | {"STATE", "FAILS", "OLDER", "OUTSIDE"}
_ENDS = OPENINGS | {"ELSE"}
_CASES = _ENDS - {"UNTIL"}


def merged(words: list[Word]) -> list[Word]:
    """The words, those that belong together in one; words of two senses told apart."""
    words = _joined_bounds(_numbers(_inverted(words)))
    found: list[Word] = []
    i = 0
    while i < len(words):
        word = words[i]
        after = words[i + 1] if i + 1 < len(words) else None
        before = found[-1].type if found else ""
        pair = counted(word, after, before) if after is not None else None
        if pair is not None:
            word = pair
            i += 1
        elif _is_implied(words, i):
            i += 1
            continue
        elif word.type == "KIND" and word.value[1] is None:
            kind, _, definite = word.value
            word = replace(word, value=(kind, _is_list(words, i + 1), definite))
        elif word.type in _UPTO and after is not None and after.type == "NUMBER":
            if [w.type for w in found[-2:]] == ["FLOOR", "NUMBER"]:  # `floors 1 to 4`
                word = replace(word, type="UPTO")
        elif word.type == "A_UNIT":
            per = bool(found) and found[-1].type in ("TIMES", "TIME_WORD")  # `twice an hour`
            length = Length(word.value, word.value)
            word = replace(word, type="STRAY" if per else "DURATION", value=length)
        i += 1
        _add(word, after, found)
    return _last_if(limited(_of_values(found)))


def _is_list(words: list[Word], i: int) -> bool:
    """Whether numbers are listed behind `Manometer` or `PG`, which then are several."""
    types = [word.type for word in words[i : i + 4]]
    types = types[1:] if types[:1] == ["HASH"] else types
    return types[1:2] != [] and types[1] in _LISTING and types[2:3] in (["NUMBER"], ["IDENT"])


def _of_values(words: list[Word]) -> list[Word]:
    """`Above 60 psi, check ...` is a condition; `the valve stands at more than 3 degrees` says what
    it shows."""
    types = [word.type for word in words[:3]]
    first = types[:1] == ["AT"]
    if "QUANTITY" in types[first + 1 :] and types[first] in _RELATIONS:
        opening = Word("IF", None, words[first].start, words[first].start)
        words = [opening, *words[first:]]
    for i in range(len(words) - 3, -1, -1):
        start, at, relation = words[i : i + 3]
        if (start.type, at.type) == ("START", "AT") and relation.type in _VALUES:
            words = [*words[:i], replace(start, type="IS", value=None), *words[i + 2 :]]
    return words


def _inverted(words: list[Word]) -> list[Word]:
    """`Should the alarm sound, ...` is a condition; `should` says nothing elsewhere."""
    found: list[Word] = []
    for i, word in enumerate(words):
        asks = i + 1 < len(words) and words[i + 1].type in _ASKED_OF
        begins = not found or found[-1].type in ("JOINT", "ELSE")
        if asks and (not found if word.type == "IS" else begins and word.type == "SHOULD"):
            found.append(replace(word, type="IF", value=None))
        elif word.type == "SHOULD" and not found:
            found.append(replace(word, type="STRAY"))  # `Should the robot check #4?`
        elif word.type != "SHOULD":
            found.append(word)
    return found


def _last_if(words: list[Word]) -> list[Word]:
    """`check checkpoint 3, if there is a reason`: at the end of a sentence a condition belongs to
    what stands before it, with or without a comma."""
    at = next((i for i in range(len(words) - 1, 0, -1) if words[i].type == "IF"), 0)
    if at < 2 or words[at].value is not None or words[at - 1].value != ",":
        return words
    last = words[-1] if words[-1].value != "." else words[-2]
    compared = last.type == "NUMBER" and words[words.index(last) - 1].type in _RELATIONS
    asked = compared or last.type in ("STATE", "FAILS", "QUANTITY", "IS")
    if not asked or any(word.type in VERBS for word in words[at:]):
        return words
    if any(word.type == "IF" for word in words[:at]):
        return words
    return [*words[:at], replace(words[at], type="IF_ONLY"), *words[at + 1 :]]


def _is_implied(words: list[Word], i: int) -> bool:
    """Return True for a word that adds nothing to its neighbours: `after` in `and after #4`."""
    match words[i].type:
        case "AFTER":  # `first checkpoint 3 and after checkpoint 4`
            return _comes_next(words, i)
        case "ORDINAL":  # `checkpoint 13 first, then ...`
            return _tells_order(words, i)
        case "BOTH":  # `both #1 and #4`
            return _names_two(words[i + 1 : i + 8])
        case "EITHER":  # `either #1 or #4`
            joints = [str(w.value) for w in words[i + 1 : i + 12] if w.type == "JOINT"]
            return "or" in next((said for said in joints if "or" in said or "and" in said), "")
    return False


def _tells_order(words: list[Word], i: int) -> bool:
    """Whether an ordinal says only what comes when, and not which floor or gauge is meant:
    `first check ...`, `checkpoint 13 first, then ...`."""
    next_ = words[i + 1 : i + 3]
    ordered = next_[1:] if next_[:1] and next_[0].type == "IT" else next_[:1]
    if words[i].value == 1 and (any(w.type in VERBS for w in ordered) or _begins_name(next_)):
        return True
    after = next((w for w in words[i + 1 :] if w.type not in _BETWEEN_FLOORS), None)
    listed = i + 1 < len(words) and words[i + 1].type in ("JOINT", "ORDINAL")
    if words[i].value > 1 and i > 0 and words[i - 1].type in _LABELS:
        return False  # `check 8 second, 1 first`
    return after is None or (after.type != "FLOOR" and listed)


def _begins_name(words: list[Word]) -> bool:
    """Whether a checkpoint is named that needs no counting: `first valve R7`."""
    first, second = ([word.type for word in words[:2]] + ["", ""])[:2]
    return first == "HASH" or (first == "KIND" and second in _LABELS - {"STRING"} | {"HASH"})


def _comes_next(words: list[Word], i: int) -> bool:
    """Whether `after` says only what comes next: `first valve R7 and after valve R9`."""
    first = any(word.type == "ORDINAL" and word.value == 1 for word in words[:i])
    joined = i > 0 and words[i - 1].is_and
    verbs = any(word.type in VERBS for word in words[i:])
    return first and joined and not verbs and _begins_name(words[i + 1 :])


def _names_two(words: list[Word]) -> bool:
    """`checkpoint 1 and checkpoint 4`"""
    named = [word for word in words if word.type not in ("KIND", "HASH")][:3]
    return (
        len(named) == 3
        and named[1].is_and
        and {named[0].type, named[2].type} <= {"NUMBER", "IDENT", "STRING"}
    )


def _numbers(words: list[Word]) -> list[Word]:
    if all(word.type != "NUMBER_WORD" for word in words):
        return words
    found: list[Word] = []
    i = 0
    while i < len(words):
        value, n = compose(
            [w.value if w.type == "NUMBER_WORD" else None for w in words[i : i + 12]]
        )
        if n:
            number = Word("NUMBER", Figure(float(value)), words[i].start, words[i + n - 1].end)
            i += n
            found.append(_one_of_them(number, found, words[i : i + 1]))
        else:
            found.append(words[i])
            i += 1
    return found


def _one_of_them(number: Word, found: list[Word], after: list[Word]) -> Word:
    """`If one is abnormal` asks about one of them, and not about checkpoint 1; `if two are` is not
    known."""
    last = found[-1].type if found else ""
    asked = last in OPENINGS or (last == "IS" and _begins(found))  # `Ist eins auffällig, ...`
    if not (asked and after and after[0].type in _SAID):
        return number
    one = number.value.value == 1
    return replace(number, type="THEM", value="either") if one else replace(number, type="STRAY")


def _joined_bounds(words: list[Word]) -> list[Word]:
    """`above 5 and below 7` has two bounds, `5 and below` has one."""
    found: list[Word] = []
    for i, word in enumerate(words):
        after = words[i + 1].type if i + 1 < len(words) else ""
        if word.type in _BEYOND and word.value and after in ("NUMBER", "NUMBER_WORD", "MINUS"):
            middle = word.start + len(word.value)
            found.append(Word("JOINT", word.value, word.start, middle))
            word = Word(_BEYOND[word.type], None, middle + 1, word.end)
        found.append(word)
    return found


def _add(word: Word, after: Word | None, found: list[Word]) -> None:
    """Adds a word, by what stands beside it."""
    last = found[-1] if found else None
    added = last is not None and last.type == "JOINT" and last.value in _ADDING
    before = found[-2] if added and len(found) > 1 else last
    sum_ = total(before, word) if before is not None else None
    clock = hours_and(last, word, after) if last is not None else None
    if before is not None and sum_ is not None:
        del found[found.index(before) :]
        word = sum_
    elif clock is not None:
        found.pop()
        word = clock
    elif word.type == "HALF" and before is not None and before.type == "DURATION":
        longer = before.value.seconds + before.value.unit / 2
        del found[found.index(before) :]
        word = Word("DURATION", Length(longer), before.start, word.end)
    elif word.type == "SPEED":
        while found and found[-1].type in ("AT", "BY", "AT_MOST"):
            found.pop()  # the speed on a way is the highest one there
    elif word.type == "MORE_WORD" and last is not None and last.type == "TIMES":
        found[-1] = Word("MORE", last.value, last.start, word.end)  # `twice more`
        return
    elif word.type == "TIME_WORD" and last is not None and last.type == "MORE_WORD":
        if len(found) > 1 and found[-2].type == "NUMBER":  # `two more times`
            found.pop()
            word = Word("MORE", found[-1].value, found.pop().start, word.end)
    elif word.type == "MEASURE" and after is not None and after.type in _RELATIONS:
        word = replace(word, type="IS", value=None)
    elif word.type in _AMOUNTS and [w.type for w in found[-2:]] == ["IS", "AT"]:
        found.pop()  # `is at 5 bar`, `is at more than 5 bar`
    elif word.type in ("KIND", "HASH", "ALL") and _are_rounds(found):
        rounds = found.pop()  # `do three rounds over checkpoints 5 to 8`
        number = found.pop()
        found[-1] = replace(found[-1], type="MEASURE", value=None)
        found.append(Word("TIMES", number.value, number.start, rounds.end))
    elif word.type == "BETWEEN" and (after is None or after.type in _BEHIND_BETWEEN):
        word = replace(word, type="IN_BETWEEN")  # `with a pause of 5 minutes in between`
    elif word.type == "MEASURE" and last is not None and last.type == "NOT":
        found.pop()
        word = Word("SPARE", None, last.start, word.end)  # `don't check checkpoint 19`
    elif word.type in VERBS and last is not None and last.type == "IT" and _begins(found):
        if word.type != "MEASURE" or (after is not None and after.type != "JOINT"):
            found.pop()  # `it reads checkpoint 4`, but `es prüfen`
    elif word.type == "IF" and last is not None and last.type not in _OPENING:
        word = replace(word, type="IF_ONLY")
    elif word.type == "UNLESS" and (last is None or last.value in (";", ".")):
        word = replace(word, type="IF", value="unless")
    elif word.type == "AREA" and last is not None and last.type == "START" and len(found) > 1:
        if found[-2].type in ("IN", "AT", "FROM", "TO", "ON"):
            found.pop()  # `in start area 1`
    elif word.type in ("ON", "IN") and after is not None and after.type in ("EVENT", "FAILS"):
        word = replace(word, type="IF")
    elif word.type in _EARLY and last is not None and last.type == "IF_TIME" and _begins(found):
        found[-1:] = [word, last]  # `optionally check checkpoint 4`
        return
    found.append(word)


def _are_rounds(found: list[Word]) -> bool:
    """Whether it is said before that rounds are done of what comes next."""
    types = [word.type for word in found[-3:]]
    return types[1:] == ["NUMBER", "ROUNDS_OF"] and types[0] in ("REPEAT", "GO", "PATROL")


def _begins(found: list[Word]) -> bool:
    """Whether the last word begins a sentence or what is joined to one."""
    return len(found) < 2 or found[-2].type in _OPENING


# ---- what is not so without `not`: `neither A nor B is above 5`, `outside 3 to 4`


def negated(words: list[Word]) -> list[Word]:
    """The words with `not` in its place; `not outside` is inside."""
    found: list[Word] = []
    neither: Word | None = None
    for i, word in enumerate(words):
        if word.type == "IN_ANY_CASE" and not any(w.type in _CASES for w in words[:i]):
            continue  # behind a condition it is not clear whether it depends on that
        if word.type == "NEITHER" and any(words[k].type in _PREDICATES for k in _clause(words, i)):
            neither = word
            if word.value == "them":
                found.append(replace(word, type="THEM", value="all"))
            continue
        if neither is not None and word.type == "NOR":
            found.append(replace(word, type="JOINT", value="and"))
            continue
        if neither is not None and word.type in _PREDICATES:
            found.append(replace(neither, type="NOT"))
            neither = None
        found += _outside(words, i, found) if word.type == "OUTSIDE" else [word]
    return found


def _clause(words: list[Word], i: int) -> range:
    ends = (k for k in range(i + 1, len(words)) if words[k].type in _ENDS)
    return range(i + 1, next(ends, len(words)))


def _outside(words: list[Word], i: int, found: list[Word]) -> list[Word]:
    """`not from`; a `not` before it is taken away with it."""
    after = words[i + 1].type if i + 1 < len(words) else ""
    range_ = [] if after in ("FROM", "BETWEEN") else [replace(words[i], type="FROM")]
    if found and found[-1].type == "NOT":
        found.pop()
        return range_
    return [replace(words[i], type="NOT"), *range_]
