"""Lines of a letter that is answered, `> Check #1`: they may be of another plan than the others."""

from collections.abc import Iterator, Sequence

from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.orders import Sentence, Start
from argo_compiler.script.syntax.tree.script import ScriptStep


def ask_of_quotes(steps: Sequence[ScriptStep], diagnostics: Diagnostics) -> None:
    """Asks which orders count, where some are quoted and others are not."""
    lines = diagnostics.source.lines
    ordered = list(_ordered(steps))
    quoted = [s for s in ordered if lines[s.span.line - 1].lstrip().startswith(">")]
    if not 0 < len(quoted) < len(ordered):
        return
    other = next(s for s in ordered if s not in quoted)
    message = f"this is quoted, and line {other.span.line} is not: it may be done as well, or be "
    message += "of another plan"
    hint = "leave out what is not to be done, and `>` before what is"
    diagnostics.error("ambiguous-quote", message, quoted[0].span, hint)


def _ordered(steps: Sequence[ScriptStep]) -> Iterator[Sentence]:
    """The sentences with orders other than to start."""
    for step in steps:
        for sentence in step.sentences:
            if isinstance(sentence, Sentence) and any(
                not isinstance(order, Start) for order in sentence.orders
            ):
                yield sentence
        yield from _ordered(step.steps)
