"""Joints: what a comma, `and` or `or` joins, told by the word behind it.

The parser looks one word ahead. Whether `, and` goes on with a list of checkpoints, with a
condition or with another order is known there only because the joint's type says so.
"""

from dataclasses import replace

from argo_compiler.script.sentences.words.word import COMPARISONS, VERBS, Word

_NOUNS = [
    *("KIND", "HASH", "IDENT", "STRING", "ALL", "IT", "THEM", "BOTH", "THIS", "OF", "VALUE"),
    "EVERYTHING",
]
_TESTS = [*COMPARISONS, "IS", "EXACTLY", "STATE", "NOT", "FAILS"]
_PLACES = ["FLOOR", "FLOOR_NAME", "ORDINAL", "AREA", "PLACE"]
_IN_BRACKETS = frozenset(
    [*("KIND", "HASH", "NUMBER", "IDENT", "STRING", "MINUS", "AREA", "IN", "AT", "ON", "TO")]
)
"""what may begin the other name of a checkpoint, or coordinates"""
_ENDING = frozenset(["UNTIL", "FOR", "TIMES", "MOST_TIMES", "MOST_TIME"])
"""what may end a repetition"""
_CASES = frozenset(["IF", "IF_ONLY", "UNLESS"])
_JOINED = {
    **dict.fromkeys(VERBS, "DO"),
    **dict.fromkeys(_NOUNS, "NOUN"),
    **dict.fromkeys(_TESTS, "TEST"),
    **dict.fromkeys(_PLACES, "PLACE"),
    **dict.fromkeys(["EVENT", "BATTERY"], "EVENT"),
    **dict.fromkeys(["QUANTITY", "DURATION", "MINUS"], "AMOUNT"),
    "NUMBER": "NUMBER",
    **dict.fromkeys(["ON", "IN"], "ON"),
}


def joined(words: list[Word]) -> list[Word]:
    """The words with typed joints; joints that join nothing of these are kept in `before`."""
    found: list[Word] = []
    joints: list[Word] = []
    named = -1
    for i, word in enumerate(words):
        if word.type == "JOINT":
            joints.append(word)
            continue
        if word.type == "LPAR" and i + 1 < len(words) and words[i + 1].type not in _IN_BRACKETS:
            word = replace(word, type="LPAR_HOW")
        name = _is_name(words, i)
        if joints:
            said = " ".join(joint.value for joint in joints)
            kind = _type(said, word)
            if kind == "COLON" and word.type == "KIND" and _is_named(found):
                kind = "NAMELY"
            if name:
                kind = "NEXT"
            elif named == len(found) - 1 >= 0:
                kind = "COLON"
            if kind is None and "or" in said and not _ends_either_way(found, word):
                kind = "OR_DO"
            if kind is not None and (found or "or" in said):
                found.append(Word(kind, said, joints[0].start, joints[-1].end))
            word = Word(word.type, word.value, word.start, word.end, said)
            joints = []
        named = len(found) if name else named
        found.append(word)
    return found


def _ends_either_way(found: list[Word], word: Word) -> bool:
    """Return True for `twice or until ...`, where what comes first ends it, and for `if ..., or if
    ...`; any other `or` that joins no two of a kind is left to be asked about."""
    before = {other.type for other in found}
    ends = word.type in _ENDING and not before.isdisjoint(_ENDING)
    return ends or (word.type in _CASES and not before.isdisjoint(_CASES))


def _is_name(words: list[Word], i: int) -> bool:
    """Whether a word is the name that stands before an order: `"gate": go to (1, 2, 0)`."""
    if words[i].type != "STRING" or (i > 0 and words[i - 1].type != "JOINT"):
        return False
    after = words[i + 1] if i + 1 < len(words) else None
    return after is not None and after.type == "JOINT" and after.value == ":"


def _is_named(found: list[Word]) -> bool:
    """Whether the words end with a checkpoint's number: `Checkpoint #4: valve R25`."""
    types = [word.type for word in found[-2:]]
    return types in (["HASH", "NUMBER"], ["KIND", "NUMBER"])


def _type(said: str, word: Word) -> str | None:
    what = _JOINED.get(word.type)
    if what is None:
        return None
    if what == "DO":
        return "OR_DO" if "or" in said else "NEXT"
    if ":" in said:
        return "COLON"
    if "but" in said and what in ("NOUN", "NUMBER"):
        return "BUT"  # `in any order, but checkpoint 9 before checkpoint 14`
    return f"{'OR' if 'or' in said else 'AND'}_{what}"
