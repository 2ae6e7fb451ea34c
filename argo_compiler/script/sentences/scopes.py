"""Asks what a part of a sentence belongs to, where it can belong to one order or to several."""

from collections.abc import Sequence

from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.sentences.tree.conditions import Test
from argo_compiler.script.sentences.tree.nouns import Nouns, Pronoun
from argo_compiler.script.sentences.tree.orders import (
    Go,
    Home,
    Measure,
    Patrol,
    ScriptOrder,
    Sentence,
)


def ask_of_scopes(
    sentence: Sentence, alternatives: Sequence[str], diagnostics: Diagnostics
) -> None:
    """Add an error for each part of a sentence that can belong to several of its orders.

    Args:
        sentence: the sentence
        alternatives: the words for `or`
        diagnostics: to which errors are added
    """
    groups = (sentence.orders, *(case.orders for case in sentence.cases))
    for orders in groups:
        for i, order in enumerate(orders):
            _ask_of_way_home(order, orders[:i], diagnostics)
            _ask_of_patrol(order, alternatives, diagnostics)
            _ask_of_pronoun(order, orders[:i], diagnostics)


def _ask_of_way_home(
    order: ScriptOrder, before: tuple[ScriptOrder, ...], diagnostics: Diagnostics
) -> None:
    """Ask about `check #1 and go home twice`."""
    if before and isinstance(order, Go | Home) and order.manner.times is not None:
        message = "this count can be that of the way only, or of all that stands before it"
        hint = "write `do the following twice:` over the tasks for the second"
        diagnostics.error("ambiguous-manner", message, order.span, hint)


def _ask_of_patrol(
    order: ScriptOrder, alternatives: Sequence[str], diagnostics: Diagnostics
) -> None:
    """Ask about `patrol floor 1 three times for 10 minutes`; with `or`, what ends first ends it."""
    manner = order.manner
    if not isinstance(order, Patrol) or not manner:
        return
    if not {*alternatives}.isdisjoint(diagnostics.source.said(order.span).lower().split()):
        return
    if manner.times is not None and manner.duration is not None and manner.every is None:
        message = "the time can be that of each round, of all rounds, or the longest one allowed"
        hint = "state the number of rounds or the time, or write `for at most 10 minutes`"
        diagnostics.error("ambiguous-manner", message, order.span, hint)


def _ask_of_pronoun(
    order: ScriptOrder, before: tuple[ScriptOrder, ...], diagnostics: Diagnostics
) -> None:
    """Ask about `check #3 and check #6 if it is above 4`."""
    condition = order.manner.condition
    measured = any(isinstance(other, Measure) for other in before)
    if condition is None or not measured or not isinstance(order, Measure):
        return
    for test in condition.tests:
        if isinstance(test, Test) and _is_pronoun(test.subject):
            message = "this can be the value of the checkpoint before it, or of an earlier one"
            hint = "name the checkpoint: `check #6 if #3 is above 4`"
            diagnostics.error("ambiguous-pronoun", message, test.span, hint)


def _is_pronoun(subject: Nouns | None) -> bool:
    return subject is None or all(
        isinstance(noun, Pronoun) and not noun.every for noun in subject.nouns
    )
