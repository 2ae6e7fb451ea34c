"""The rows of a mission sheet: what the grammar's trees of them mean."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar

from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.building import Builder, Figure, Numbered, Phrase, Time
from argo_compiler.script.syntax.nodes import ModeField, OrderField, SheetStep
from argo_compiler.script.syntax.source import ScriptText
from argo_compiler.script.syntax.terms import Duration, Name, Number, Quantity, Reference


class Label(StrEnum):
    """The fields of the sheet that hold free words, by their names in `Sheet`."""

    DESIGNATION = "designation"
    ANOMALY = "anomaly_specification"
    REAL_TIME = "real_time_reporting"
    AFTER_MISSION = "after_mission_report"
    INITIAL = "initial_position"
    END = "end_of_mission"


@dataclass
class Cell:
    """A field of free words while its lines are gathered."""

    label: Label
    at: ScriptText
    """the row with the label"""
    parts: list[ScriptText]
    continues: bool = False
    """the row has the second line of a label that stands in two"""


class RowBuilder(Builder):
    """Builds the rows of a sheet."""

    constants: ClassVar[dict[str, Any]] = {
        **Builder.constants,
        "heading": None,
    }

    designation_label = anomaly_label = specification_label = Builder.label_end
    real_time_label = after_mission_label = Builder.label_end
    initial_position_label = end_of_mission_label = Builder.label_end

    def _cell(self, label: Label, phrase: Phrase) -> Cell:
        text = self.field_text(phrase)
        return Cell(label, self.text, [text] if text.content else [])

    def designation(self, phrase: Phrase) -> Cell:
        return self._cell(Label.DESIGNATION, phrase)

    def anomaly(self, phrase: Phrase) -> Cell:
        return self._cell(Label.ANOMALY, phrase)

    def specification(self, phrase: Phrase) -> Cell:
        if report := phrase.first(Cell):
            return report
        cell = self._cell(Label.ANOMALY, phrase)
        cell.continues = True
        return cell

    def real_time(self, phrase: Phrase) -> Cell:
        return self._cell(Label.REAL_TIME, phrase)

    def after_mission(self, phrase: Phrase) -> Cell:
        return self._cell(Label.AFTER_MISSION, phrase)

    def initial_position(self, phrase: Phrase) -> Cell:
        return self._cell(Label.INITIAL, phrase)

    def end_of_mission(self, phrase: Phrase) -> Cell:
        return self._cell(Label.END, phrase)

    def main_mode(self, phrase: Phrase) -> ModeField:
        return ModeField(span=phrase.span, mode=phrase.the(Mode))

    def max_duration(self, phrase: Phrase) -> Duration:
        return self.duration(phrase.every(Time))

    def order(self, phrase: Phrase) -> OrderField:
        return OrderField(span=phrase.span, order=phrase.the(Order))

    def step(self, phrase: Phrase) -> SheetStep:
        reference = phrase.first(Numbered)
        return SheetStep(
            span=phrase.span,
            number=phrase.first(int),
            checkpoint=Reference(
                span=reference.phrase.span if reference else phrase.span,
                number=reference.number if reference else None,
                name=phrase.first(Name),
                quantity=phrase.first(Quantity),
            ),
        )

    def area(self, phrase: Phrase) -> Figure:
        return phrase.the(Figure)

    def areas(self, phrase: Phrase) -> tuple[Number, ...]:
        return tuple(figure.node for figure in phrase.every(Figure))
