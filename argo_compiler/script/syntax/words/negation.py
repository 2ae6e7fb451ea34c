"""What is said to be not so without `not`: `neither A nor B is above 5`, `outside 3 to 4`."""

from dataclasses import replace

from argo_compiler.script.syntax.words.word import Word

_PREDICATES = frozenset(
    ["GREATER", "LESS", "AT_LEAST", "AT_MOST", "BETWEEN", "STATE", "FAILS", "OLDER", "OUTSIDE"]
)
_CASES = frozenset(["IF", "IF_ONLY", "UNLESS", "ELSE"])
_ENDS = frozenset(["IF", "IF_ONLY", "UNLESS", "UNTIL", "ELSE"])


def negated(words: list[Word]) -> list[Word]:
    """The words with `not` in its place; `not outside` is inside."""
    found: list[Word] = []
    neither: Word | None = None
    for i, word in enumerate(words):
        if word.type == "IN_ANY_CASE" and not any(w.type in _CASES for w in words[:i]):
            continue  # behind a condition it is not clear whether it depends on that
        if word.type == "NEITHER" and any(_is_predicate(words, k) for k in _clause(words, i)):
            neither = word
            if word.value == "them":
                found.append(replace(word, type="THEM", value="all"))
            continue
        if neither is not None and word.type == "NOR":
            found.append(replace(word, type="JOINT", value="and"))
            continue
        if neither is not None and _is_predicate(words, i):
            found.append(replace(neither, type="NOT"))
            neither = None
        found += _outside(words, i, found) if word.type == "OUTSIDE" else [word]
    return found


def _clause(words: list[Word], i: int) -> range:
    ends = (k for k in range(i + 1, len(words)) if words[k].type in _ENDS)
    return range(i + 1, next(ends, len(words)))


def _is_predicate(words: list[Word], i: int) -> bool:
    return words[i].type in _PREDICATES


def _outside(words: list[Word], i: int, found: list[Word]) -> list[Word]:
    """`not from`; a `not` before it is taken away with it."""
    after = words[i + 1].type if i + 1 < len(words) else ""
    range_ = [] if after in ("FROM", "BETWEEN") else [replace(words[i], type="FROM")]
    if found and found[-1].type == "NOT":
        found.pop()
        return range_
    return [replace(words[i], type="NOT"), *range_]
