"""Small words that change nothing where they mostly stand, and what is meant where they stand here.

Of `if only one of them is above 4`, `check 8 also if ...`, `go back there` that is asked. What
words say of where something stands, `at the end`, `first of all`, `there`, has to be so: else it is
asked what is meant.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import TypeGuard

from argo_compiler.script.documents.source import Diagnostics, ScriptText
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.conditions import Test, TooLate
from argo_compiler.script.sentences.tree.nouns import AllOf, Labelled, TheOne
from argo_compiler.script.sentences.tree.orders import Case, Placed, Placing, ScriptOrder, Sentence
from argo_compiler.script.sentences.tree.script import Said, ScriptStep
from argo_compiler.script.sentences.words.lexer import all_words, placed_words
from argo_compiler.script.sentences.words.lexicon import Lexicon
from argo_compiler.script.sentences.words.loading import everywhere
from argo_compiler.script.sentences.words.without_effect import (
    TOLD,
    WITHOUT_EFFECT,
    parts_list,
    without_empty,
)
from argo_compiler.script.sentences.words.word import COMPARISONS, OPENINGS, VERBS, Word

_ENDS = frozenset([*VERBS, *COMPARISONS, "STATE", "FAILS", "IS"])
"""words behind which a condition says no more of which checkpoints it is"""
_FROM_START = frozenset(["SINCE_START", "BACK_IN", "MAX_DURATION"])
_NAMED = frozenset(["KIND", "HASH", "NUMBER", "IDENT", "STRING", "IT", "THEM", "BOTH", "THIS"])
_WORK = (orders.Measure, orders.VisitOrder, orders.Go, orders.Patrol)
_SCOPED = frozenset(
    [
        *("TIMES", "MORE", "SPEED", "LEAVING", "EVERY", "RETRY", "MOST_TIMES", "PRIORITY"),
        *("RATE", "TIME_WORD", "UNIT_S", "ANY_ORDER", "IF_TIME", "FOR", "DURATION", "READING"),
        *("IF_ONLY", "UNLESS", "UNTIL"),
    ]
)
"""what may be meant of the last item of a list, or of all"""
_AND_SO_ON = re.compile(r"(?:^|[\d,])\s*(\.{3}|…)(?=\s|$)")


@dataclass(frozen=True)
class Doubt:
    """What a word may change, and how to say what is meant."""

    message: str
    hint: str


_ONLY = Doubt(
    "can mean that the others do not satisfy this",
    "remove it, or write the condition for the others, too",
)
_ONLY_THEN = Doubt(
    "can mean only in that case, or only after that",
    "write `if ..., then ...` for the first, and remove it for the second",
)
_SUM = Doubt("can mean their sum, or each of them", "write `and` for the second")
_ALSO = Doubt(
    "can mean `if`, or `even if`",
    "write `if ...` for the first, and remove the condition for the second",
)
_WITHIN = Doubt(
    "can count from the start of the mission, or from the previous task",
    "write `within 10 minutes of the start`; Argo counts times from the start only",
)
_THERE = Doubt(
    "can be the docking station, or the place named before",
    "name the place: `return to the docking station`",
)
_MAY_BE = Doubt(
    "can mean that what follows is done in some cases only, or always",
    "write `if there is time, ...`, or leave it out",
)
_LAST_OR_ALL = Doubt(
    "can mean that what comes behind the list is meant of its last item, or of all",
    "write two sentences",
)
_AND_BACK = Doubt(
    "can mean the path home, or the same checkpoints in reverse order",
    "name the tasks on the way back",
)


def ask_of_dots(text: ScriptText, diagnostics: Diagnostics) -> None:
    """Asks about `Check 1, 4, ...`."""
    dots = _AND_SO_ON.search(text.content)
    if dots is not None:
        message = f"`{dots[1]}` can mean that more tasks follow"
        hint = "write all tasks, or remove the dots"
        diagnostics.error("ambiguous-word", message, text.span(*dots.span(1)), hint)


def is_question(text: ScriptText, lexicon: Lexicon) -> bool:
    """Return True for a sentence with a question mark that is no polite order: `could you ...?`."""
    behind = text.source.text[text.last + 1 : text.last + 3].lstrip()
    if not behind.startswith("?"):
        return False
    return all(word.type != "COURTESY" for word in all_words(text.content, lexicon)[:3])


def ask_of_words(
    text: ScriptText,
    lexicon: Lexicon,
    diagnostics: Diagnostics,
    ordered: bool,
    days: dict[str, int],
) -> None:
    """Asks about the words of a sentence that may change what is meant. `ordered`: something is
    to be done before it; `days`: the days of which sentences were so far, each with its line."""
    words = all_words(text.content, lexicon)
    doubts = dict(_doubts(words, text.content.lower(), ordered))
    for i, word in enumerate(words):
        shown, span = text.content[word.start : word.end], text.span(word.start, word.end)
        doubt = doubts.get(i)
        if doubt is not None:
            diagnostics.error("ambiguous-word", f"`{shown}` {doubt.message}", span, doubt.hint)
        elif word.type in TOLD and not _opens_condition(words, i):
            other = next((day for day in days if day != shown.lower()), None)
            if word.type == "DAY" and other is not None:
                message = f"`{shown}` is another day than `{other}` in line {days[other]}"
                hint = "write a script for each day, without the name of the day"
                diagnostics.error("ambiguous-word", message, span, hint)
                continue
            if word.type == "DAY":
                days.setdefault(shown.lower(), span.line)
            diagnostics.warning("no-effect", f"`{shown}` has no effect", span)


def _doubts(words: Sequence[Word], content: str, ordered: bool) -> Iterator[tuple[int, Doubt]]:
    """Yield the doubts, each with the index of its word."""
    for i, word in enumerate(words):
        shown = content[word.start : word.end]
        after = [w.type for w in words[i + 1 :] if w.type not in WITHOUT_EFFECT]
        before = words[i - 1] if i > 0 else None
        orders_ = sum(w.type in VERBS and w.type != "START" for w in words[:i])
        match word.type:
            case "FOCUS":
                if _names_subject(words, i) and after[:1] and after[0] in _NAMED:
                    yield i, _ONLY
                elif i == 0 and _is(_next(words, i, content), "following"):
                    yield i, _ONLY_THEN
            case "ADDITION":
                behind = [type_ for type_ in after if type_ != "JOINT"]
                bidden = any(w.type in VERBS for w in words[:i])
                if bidden and behind[:1] == ["IF"] and not {*VERBS} & {*behind}:
                    yield i, _ALSO
            case "THITHER" if after[:2] == ["JOINT", "BACK"]:
                yield i, _AND_BACK
            case "LPAR" if _counts(after) and _ends_list(words[:i]):
                yield i, _LAST_OR_ALL
            case "BIDDING" | "SHOULD" if i == 0 and content[word.end : word.end + 1] == ":":
                if not _is(shown, "requiring"):
                    yield i, _MAY_BE
            case "SEQUENCE" if _is_within_list(words, i):
                clause = takewhile(lambda type_: type_ not in VERBS, after)
                parted = parts_list(words, i, without_empty(words[:i]))
                if _SCOPED.intersection(clause) and not parted:
                    yield i, _LAST_OR_ALL
            case "JOINT" if _is(shown, "summing") and _names_subject(words, i):
                yield i, _SUM
            case "WITHIN" if ordered or orders_ > 1:
                types = {w.type for w in words}
                first = re.search(rf"\b(?:{everywhere('of_start')})\b", shown)  # `within the first`
                if types.isdisjoint(_FROM_START) and first is None:
                    yield i, _WITHIN
            case "THERE" if before is not None and before.type == "HOME":
                yield i, _THERE


def _opens_condition(words: Sequence[Word], i: int) -> bool:
    """Return True for the `only` of `check #4 only if #1 is above 3`, which a condition has."""
    return i + 1 < len(words) and words[i + 1].type in OPENINGS


def _is_within_list(words: Sequence[Word], i: int) -> bool:
    """Return True for a word between two checkpoints of a list: `#1 and then #4`."""
    before = [word.type for word in without_empty(words[:i])]
    after = next((w.type for w in words[i + 1 :] if w.type not in WITHOUT_EFFECT), "")
    joined = before[-1:] == ["JOINT"] and bool({*before} & {"MEASURE", "BE_MEASURED"})
    return joined and after in _NAMED | {"ALL", "EVERY"}


def _counts(types: Sequence[str]) -> bool:
    """Return True for what stands in `(3x)`, `(twice)`."""
    return [*types[:2]] == ["NUMBER", "X"] or [*types[:1]] in (["TIMES"], ["MORE"])


def _ends_list(words: Sequence[Word]) -> bool:
    """Return True for words that end with a list: `PG1, then PG2`."""
    clause = [*takewhile(lambda word: word.type not in OPENINGS, reversed(words))]
    return sum(word.type in _NAMED | {"IDENT", "NUMBER"} for word in clause) > 2


def _next(words: Sequence[Word], i: int, content: str) -> str:
    """The word behind one."""
    return content[words[i + 1].start : words[i + 1].end] if i + 1 < len(words) else ""


def _names_subject(words: Sequence[Word], i: int) -> bool:
    """Whether a word stands where a condition says of which checkpoints it is."""
    last = next((w.type for w in reversed(words[:i]) if w.type in OPENINGS | _ENDS), "")
    return last in OPENINGS


def _is(said: str, name: str) -> bool:
    return re.fullmatch(everywhere(name), said) is not None


# ---- where something stands


def placed_in(text: ScriptText, node: Sentence, lexicon: Lexicon) -> tuple[Placed, ...]:
    """The words of a sentence that say where it stands."""
    found: list[Placed] = []
    for word in placed_words(text.content, lexicon):
        span = text.span(word.start, word.end)
        at = (span.line, span.column)
        before = sum((o.span.line, o.span.column) < at for o in node.orders)
        first = word.type in ("ORDINAL", "FIRST")
        placing = Placing.AT_BEGIN if first else Placing(word.type)
        found.append(Placed(span=span, placing=placing, orders=before))
    return tuple(found)


def asks_for_work(sentence: Said) -> bool:
    """Return True for a sentence that orders to measure or to drive somewhere but home."""
    orders_ = sentence.orders if isinstance(sentence, Sentence) else ()
    return any(isinstance(order, _WORK) for order in orders_)


def returns_at_end(sentence: Said) -> TypeGuard[Sentence]:
    """Return True for `At the end, return to the docking station`, and nothing else."""
    if not isinstance(sentence, Sentence) or sentence.cases or sentence.facts:
        return False
    at_end = {placed.placing for placed in sentence.placed} == {Placing.AT_END}
    return at_end and len(sentence.orders) == 1 and isinstance(sentence.orders[0], orders.Home)


@dataclass
class PlacingCheck:
    """Looks at the sentences of a script, one after the other."""

    diagnostics: Diagnostics
    last: Placed | None = None
    """what is said to be done at the end"""
    line: int = 0
    """of the first order to do something; 0: none was given yet"""

    def steps(self, steps: Iterable[ScriptStep]) -> None:
        """Says where a word is not so."""
        for step in steps:
            for sentence in step.sentences:
                if isinstance(sentence, Sentence):
                    self._sentence(sentence)
            if step.steps:
                self.steps(step.steps)

    def _sentence(self, sentence: Sentence) -> None:
        work = [order for order in sentence.orders if isinstance(order, _WORK)]
        if work and self.last is not None:
            self._not_last(self.last, work[0])
            self.last = None
        for placed in sentence.placed:
            self._placed(placed, sentence)
        if work and not self.line:
            self.line = work[0].span.line

    def _placed(self, placed: Placed, sentence: Sentence) -> None:
        before, after = sentence.orders[: placed.orders], sentence.orders[placed.orders :]
        match placed.placing:
            case Placing.THERE if _starts_and_ends(sentence):
                message = "this would end the mission where it starts, before its tasks"
                hint = "write `Start in starting area 1. End of the mission: starting area 1.`"
                self.diagnostics.error("stray-clause", message, placed.span, hint)
            case Placing.THERE:
                if any(_is_of_all(order) for order in _orders(sentence)):
                    message = "it is not clear where `there` is"
                    hint = "name the floor: `all gauges on floor 3`"
                    self.diagnostics.error("which-place", message, placed.span, hint)
            case Placing.AT_END | Placing.AT_BEGIN if any(map(_names_twice, before)):
                message = "this can move a checkpoint of the list, or ask for it once more"
                hint = "write the list in the intended order"
                self.diagnostics.error("ambiguous-measure", message, placed.span, hint)
            case Placing.AT_END if not sentence.cases:
                others = [order for order in after if before and isinstance(order, _WORK)]
                if others:
                    self._not_last(placed, others[0])
                else:
                    self.last = placed
            case Placing.INSTEAD if not all(map(_is_other_way, sentence.cases or (None,))):
                message = "it is not clear what this replaces"
                hint = "write `otherwise, ...` after the condition that it belongs to"
                self.diagnostics.error("instead", message, placed.span, hint)
            case Placing.AT_BEGIN:
                if self.line or len(before) > 1:
                    line = self.line or placed.span.line
                    message = f"this has to come first, but line {line} has a task before it"
                    hint = "write the first task above the others"
                    self.diagnostics.error("not-first", message, placed.span, hint)

    def _not_last(self, placed: Placed, other: ScriptOrder) -> None:
        message = f"this has to come last, but line {other.span.line} has a task after it"
        hint = "write the last task below the others"
        self.diagnostics.error("not-last", message, placed.span, hint)


def _orders(sentence: Sentence) -> Iterator[ScriptOrder]:
    yield from sentence.orders
    for case in sentence.cases:
        yield from case.orders


def _starts_and_ends(sentence: Sentence) -> bool:
    """Return True for `Start in starting area 1 and finish there`."""
    ends = (o for o in sentence.orders if isinstance(o, orders.Plain))
    starts = any(isinstance(order, orders.Start) for order in sentence.orders)
    return starts and any(order.word is orders.PlainWord.END for order in ends)


def _is_of_all(order: ScriptOrder) -> bool:
    """Whether an order is of checkpoints that a floor would tell."""
    return isinstance(order, orders.Measure) and any(
        isinstance(noun, AllOf | TheOne) and not noun.floors for noun in order.what.nouns
    )


def _names_twice(order: ScriptOrder) -> bool:
    """Whether an order names a checkpoint more than once."""
    nouns = order.what.nouns if isinstance(order, orders.Measure) else ()
    labels = [noun.label for noun in nouns if isinstance(noun, Labelled)]
    return len({*labels}) < len(labels)


def _is_other_way(case: Case | None) -> bool:
    """Whether a case is what is done instead of something: if it failed, or otherwise."""
    if case is None or case.condition is None:
        return case is not None
    return all(
        isinstance(test, TooLate) or (isinstance(test, Test) and test.is_of_failure)
        for test in case.condition.tests
    )
