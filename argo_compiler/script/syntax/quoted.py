"""Lines of a letter that is answered, `> Check #1`: they may be of another plan than the others."""

from collections.abc import Iterator, Sequence

from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.orders import Sentence, Start
from argo_compiler.script.syntax.tree.script import ScriptStep


def ask_of_quotes(steps: Sequence[ScriptStep], diagnostics: Diagnostics) -> None:
    """Asks which orders count, where some are quoted and others are not."""
    lines = diagnostics.source.lines
    first: dict[bool, Sentence] = {}  # that is quoted, and that is not
    for sentence in _ordered(steps):
        first.setdefault(lines[sentence.span.line - 1].lstrip().startswith(">"), sentence)
    if len(first) < 2:
        return
    line = first[False].span.line
    message = f"this is quoted, and line {line} is not: it may be done as well, or be "
    message += "of another plan"
    hint = "leave out what is not to be done, and `>` before what is"
    diagnostics.error("ambiguous-quote", message, first[True].span, hint)


def _ordered(steps: Sequence[ScriptStep]) -> Iterator[Sentence]:
    """The sentences with orders other than to start."""
    for step in steps:
        for sentence in step.sentences:
            if isinstance(sentence, Sentence) and any(
                not isinstance(order, Start) for order in sentence.orders
            ):
                yield sentence
        yield from _ordered(step.steps)
