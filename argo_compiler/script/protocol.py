"""The syntax of the mission protocol (thesis, figure 5.1): numbered commands."""

from typing import Any, ClassVar, NamedTuple

from argo_compiler.script.building import Builder, Phrase, Time
from argo_compiler.script.healing import Healed
from argo_compiler.script.nodes import (
    Add,
    AreaLocation,
    Command,
    Delete,
    DockLocation,
    Done,
    Duration,
    Go,
    Hint,
    Measure,
    Name,
    Number,
    Patrol,
    PlaceLocation,
    Protocol,
    ProtocolStep,
    Quantity,
    Reference,
    SetStart,
    Side,
    TextField,
)
from argo_compiler.script.source import Findings, Source
from argo_compiler.script.statements import Grammar, load_grammar, parse_statement

FORMS = (
    "Mission Protocol #2",
    "Set a starting point in starting area 1",
    "Set a starting point in front of the site",
    "Patrol the first floor in circles for 10 minutes",
    "Patrol floor 2 three times",
    "Check the checkpoint #14",
    "Read the position of valve R25",
    "Add checkpoint #2 after checkpoint #14",
    "Delete the measuring of checkpoint #2",
    "Go to the front of the site",
    "Return to the docking station",
    "Hint: what the planner should know",
    "Done!",
)


def protocol_grammar() -> Grammar:
    """The grammar of the protocol's lines."""
    return load_grammar("protocol", ("line",), FORMS)


class _Limits(NamedTuple):
    duration: Duration | None
    rounds: Number | None


class _LineBuilder(Builder):
    """Builds the lines of a protocol."""

    constants: ClassVar[dict[str, Any]] = {
        **Builder.constants,
        "after": Side.AFTER,
        "before": Side.BEFORE,
    }

    hint_label = Builder.label_end

    def title(self, phrase: Phrase) -> TextField:
        return TextField(span=phrase.span, text=" ".join(phrase.text.content.split()))

    def hint(self, phrase: Phrase) -> Hint:
        return Hint(span=phrase.span, text=self.field_text(phrase).content)

    def step(self, phrase: Phrase) -> ProtocolStep:
        commands = tuple(child for child in phrase.children if isinstance(child, Command))
        return ProtocolStep(span=phrase.span, number=phrase.first(int), commands=commands)

    def checkpoint(self, phrase: Phrase) -> Reference:
        quantity = phrase.first(Quantity)
        if name := phrase.first(Name):
            return Reference(span=phrase.span, name=name, quantity=quantity)
        by_number = phrase.the(Reference)
        return by_number.model_copy(update={"span": phrase.span, "quantity": quantity})

    def measure(self, phrase: Phrase) -> Measure:
        return Measure(span=phrase.span, checkpoint=phrase.the(Reference))

    def add(self, phrase: Phrase) -> Add:
        checkpoint, *anchor = phrase.every(Reference)
        return Add(
            span=phrase.span,
            checkpoint=checkpoint,
            anchor=anchor[0] if anchor else None,
            side=phrase.first(Side) or Side.AFTER,
        )

    def delete(self, phrase: Phrase) -> Delete:
        return Delete(span=phrase.span, checkpoint=phrase.the(Reference))

    def once(self, phrase: Phrase) -> Number:
        return Number(span=phrase.span, value=1)

    def twice(self, phrase: Phrase) -> Number:
        return Number(span=phrase.span, value=2)

    def rounds(self, phrase: Phrase) -> Number:
        number = phrase.the(Number)
        if number.value == 0:
            hint = "write how often, say, `three times`"
            self.findings.error("rounds", "a patrol of no rounds", phrase.span, hint)
        return number

    def limits(self, phrase: Phrase) -> _Limits:
        times = phrase.every(Time)
        return _Limits(self.duration(times) if times else None, phrase.first(Number))

    def floor(self, phrase: Phrase) -> Number:
        return phrase.the(Number)

    def patrol(self, phrase: Phrase) -> Patrol:
        limits = phrase.first(_Limits) or _Limits(None, None)
        return Patrol(
            span=phrase.span,
            floor=phrase.the(Number),
            duration=limits.duration,
            rounds=limits.rounds,
        )

    def area(self, phrase: Phrase) -> AreaLocation:
        return AreaLocation(span=phrase.span, area=phrase.the(Number))

    def dock(self, phrase: Phrase) -> DockLocation:
        area = phrase.first(AreaLocation)
        return DockLocation(span=phrase.span, area=area.area if area else None)

    def place(self, phrase: Phrase) -> PlaceLocation:
        return PlaceLocation(span=phrase.span, name=" ".join(phrase.text.content.split()))

    def set_start(self, phrase: Phrase) -> SetStart:
        return SetStart(span=phrase.span, location=phrase.children[0])

    def go(self, phrase: Phrase) -> Go:
        return Go(span=phrase.span, location=phrase.children[0])

    def done(self, phrase: Phrase) -> Done:
        return Done(span=phrase.span)


def parse_protocol(healed: Healed, source: Source) -> Protocol:
    """The protocol in the healed lines; what can't be understood is in its diagnostics."""
    findings = Findings(source, list(healed.diagnostics))
    title: TextField | None = None
    steps: list[ProtocolStep] = []
    hints: list[Hint] = []
    for line in healed.statements(findings):
        parsed = parse_statement(protocol_grammar(), "line", line.strip(), findings)
        if parsed is None:
            continue
        node = _LineBuilder(parsed.text, findings).statement(parsed.tree)
        if isinstance(node, Hint):
            hints.append(node)
        elif isinstance(node, ProtocolStep):
            steps.append(node)
        elif isinstance(node, TextField) and title is None:
            title = node
        elif isinstance(node, TextField):
            hint = "leave one of the two out"
            findings.error("repeated-field", "a second title", node.span, hint)
    return Protocol(
        source_name=source.name,
        source_text=source.text,
        title=title,
        steps=tuple(steps),
        hints=tuple(hints),
        diagnostics=findings.by_place(),
    )
