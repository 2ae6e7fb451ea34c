"""Goes through the steps of a script, with those that lie within others."""

from collections.abc import Sequence

from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.planning import Planner
from argo_compiler.script.resolve.program import Block
from argo_compiler.script.syntax.tree import facts, orders
from argo_compiler.script.syntax.tree.facts import Fact
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import Order, Sentence
from argo_compiler.script.syntax.tree.places import DockLocation
from argo_compiler.script.syntax.tree.script import Header, Step, Unread


class Stepping:
    """Plans steps."""

    def __init__(self, context: Context, planner: Planner, header: Header) -> None:
        self.context = context
        self.planner = planner
        self.header = header

    def all(self, steps: Sequence[Step]) -> None:
        """Plans all steps of a script."""
        self._check_numbers(steps)
        numbered = any(step.number is not None for step in steps)
        for i, step in enumerate(steps, start=1):
            self.context.begin_step(step.number if numbered else i)
            self._step(step, self.context.program)

    def _check_numbers(self, steps: Sequence[Step]) -> None:
        """Warns where the steps' numbers are not one after the other: a line may have been lost."""
        expected = 1
        for step in steps:
            if step.number is None:
                continue
            if step.number != expected:
                message = f"step {step.number} stands where step {expected} would be"
                hint = "is a line missing, or in the wrong place?"
                self.context.diagnostics.warning("step-number", message, step.span, hint)
            expected = step.number + 1

    def _step(self, step: Step, block: Block) -> None:
        sentences = list(step.sentences)
        following = self._taken(sentences) if step.steps else None
        for sentence in sentences:
            errors = self.context.diagnostics.errors
            if isinstance(sentence, Unread):
                self.context.fail()
            elif isinstance(sentence, Fact):
                self._fact(sentence)
            else:
                self.planner.sentence(sentence, block)
            if self.context.diagnostics.errors > errors:
                self.context.fail()
        inner = block
        if following is not None:
            round_ = self.planner.repeating.round(following, "Repeat")
            if round_ is None:
                return
            self.context.put([round_], block, block.last)
            self.context.step.append(round_)
            inner = round_.body
        for one in step.steps:
            self._step(one, inner)

    def _taken(self, sentences: list[Sentence | Fact | Unread]) -> Order | None:
        """`Do the following twice:`, taken out of the sentences over inner steps."""
        last = sentences[-1] if sentences else None
        if isinstance(last, Sentence) and last.orders and not last.cases:
            order = last.orders[-1]
            if isinstance(order, orders.Follow | orders.Amend):
                sentences.pop()
                return order
        return None

    def _fact(self, fact: Fact) -> None:
        match fact:
            case facts.MaxDuration():
                self._max_duration(fact.seconds, fact)
            case facts.BackWithin():
                self._max_duration(fact.seconds, fact)
                if isinstance(fact.where, DockLocation):
                    home = orders.Home(span=fact.span, dock=fact.where)
                    self.planner.order(home, self.context.program)
            case facts.RoundsDriven():
                manner = Manner(times=fact.count)
                order = orders.Repeat(span=fact.span, steps=fact.steps, manner=manner)
                self.planner.order(order, self.context.program)
            case _:
                message = "this can't be planned yet"
                self.context.diagnostics.error("fact", message, fact.span, "leave it out")

    def _max_duration(self, seconds: float, fact: Fact) -> None:
        said = self.header.max_duration
        if said is not None and said[0] != seconds:
            message = f"line {said[1].span.line} says another maximum duration"
            hint = "leave one of the two out"
            self.context.diagnostics.error("repeated-field", message, fact.span, hint)
        self.header.max_duration = (seconds, fact)
