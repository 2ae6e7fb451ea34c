"""Words that say where something stands: `at the end`, `first of all`, `there`.

They change nothing, so what they say has to be so: else it is asked what is meant.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache

from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import InState, Test, TooLate
from argo_compiler.script.syntax.tree.nouns import AllOf, Labelled, TheOne
from argo_compiler.script.syntax.tree.orders import Case, Placed, Placing, ScriptOrder, Sentence
from argo_compiler.script.syntax.tree.script import ScriptStep
from argo_compiler.script.syntax.words.lexer import placed_words
from argo_compiler.script.syntax.words.lexicon import Lexicon
from argo_compiler.script.syntax.words.prose import either

_WORK = (orders.Measure, orders.VisitOrder, orders.Go, orders.Patrol)


def placed_in(text: ScriptText, node: Sentence, lexicon: Lexicon) -> tuple[Placed, ...]:
    """The words of a sentence that say where it stands."""
    found: list[Placed] = []
    if _words(lexicon).search(text.content) is None:
        return ()
    for word in placed_words(text.content, lexicon):
        span = text.span(word.start, word.end)
        at = (span.line, span.column)
        before = sum((o.span.line, o.span.column) < at for o in node.orders)
        placing = Placing.AT_BEGIN if word.type == "ORDINAL" else Placing(word.type)
        found.append(Placed(span=span, placing=placing, orders=before))
    return tuple(found)


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
            case Placing.THERE:
                if any(_is_of_all(order) for order in _orders(sentence)):
                    message = "this does not say where `there` is"
                    hint = "name the floor: `all gauges on floor 3`"
                    self.diagnostics.error("which-place", message, placed.span, hint)
            case Placing.AT_END | Placing.AT_BEGIN if any(map(_names_twice, before)):
                message = "this may be said of one that stands in the list already, or once more"
                hint = "write the list in the order that is meant"
                self.diagnostics.error("ambiguous-measure", message, placed.span, hint)
            case Placing.AT_END if not sentence.cases:
                others = [order for order in after if before and isinstance(order, _WORK)]
                if others:
                    self._not_last(placed, others[0])
                else:
                    self.last = placed
            case Placing.INSTEAD if not all(map(_is_other_way, sentence.cases or (None,))):
                message = "this does not say instead of what"
                hint = "write `otherwise, ...` behind the condition whose other case it is"
                self.diagnostics.error("instead", message, placed.span, hint)
            case Placing.AT_BEGIN:
                if self.line or len(before) > 1:
                    line = self.line or placed.span.line
                    message = f"this is to be done first, and line {line} asks for something before"
                    hint = "write what is done first above the others"
                    self.diagnostics.error("not-first", message, placed.span, hint)

    def _not_last(self, placed: Placed, other: ScriptOrder) -> None:
        message = f"this is to be done at the end, and line {other.span.line} asks for more"
        hint = "write what is done at the end below the others"
        self.diagnostics.error("not-last", message, placed.span, hint)


def _orders(sentence: Sentence) -> Iterator[ScriptOrder]:
    yield from sentence.orders
    for case in sentence.cases:
        yield from case.orders


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


@cache
def _words(lexicon: Lexicon) -> re.Pattern[str]:
    """What such words look like, so that few sentences are looked at once more."""
    said = [phrase for p in Placing for phrase in lexicon.phrases.get((p, None), ())]
    return re.compile(rf"\b(?:{either('|'.join(said))}|first\W*$)\b", re.IGNORECASE)


def _is_other_way(case: Case | None) -> bool:
    """Whether a case is what is done instead of something: if it failed, or otherwise."""
    if case is None or case.condition is None:
        return case is not None
    tests = [test for tests in case.condition.alternatives for test in tests]
    return all(
        isinstance(test, TooLate)
        or (
            isinstance(test, Test)
            and isinstance(test.predicate, InState)
            and test.predicate.is_failure
        )
        for test in tests
    )
