"""What the value of a field means: `20'`, `area 2`, `in any order`.

A value is understood as a whole or refused: no word of it is passed over.
"""

import re
from dataclasses import dataclass, field
from typing import Any

from argo_compiler.base.listing import listed
from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.area_cells import AreaCells
from argo_compiler.script.syntax.asides import Asides
from argo_compiler.script.syntax.building.figures import seconds
from argo_compiler.script.syntax.building.part import RulePart
from argo_compiler.script.syntax.field_values import FieldValues
from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.orders import Sentence
from argo_compiler.script.syntax.tree.places import Coordinates, Steps
from argo_compiler.script.syntax.tree.script import AreaChosen, Text
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.lexer import unquoted
from argo_compiler.script.syntax.words.word import Word

PROSE_FIELDS = frozenset(
    ["designation", "anomaly_specification", "real_time_reporting", "after_mission_report", "site"]
)
_SAME = {"start_area": "initial_position", "end_area": "end_of_mission"}
"""fields that say the same"""


@dataclass
class FieldReader:
    """Reads the values of fields. Mutable: `first` and `last` grow field by field."""

    understanding: Understanding
    asides: Asides
    diagnostics: Diagnostics
    values: FieldValues
    first: list[Sentence] = field(default_factory=list)
    last: list[Sentence] = field(default_factory=list)
    """what is to be done at the very end: `Finish: at the front of the site`"""

    def __post_init__(self) -> None:
        self.prose = self.understanding.language.prose
        self.areas = AreaCells(self.understanding, self.asides, self.diagnostics)

    def read(self, name: str, value: ScriptText, label: ScriptText) -> None:
        """Reads a field by its name."""
        if not value.content:
            if name in PROSE_FIELDS:
                return
            message, hint = "this field says nothing", "write its value, or leave the line out"
            self.diagnostics.error("field", message, label.span(), hint)
            return
        value = self.understanding.figures(value) if name not in PROSE_FIELDS else value
        match name:
            case "nothing":
                self._nothing(value, label)
            case "mode":
                self.values.set(name, self._meaning(name, value, Mode), value)
            case "order":
                self.values.set(name, self._meaning(name, value, Order), value)
            case "max_duration":
                self.duration(value)
            case "initial_position" | "end_of_mission":
                self._place(name, value)
            case "start_area" | "end_area":
                chosen = self.areas.chosen(value)
                same = _SAME[name]
                key = (chosen.area,) if chosen and chosen.area is not None else ()
                if chosen is not None and self.values.is_new(same, key, value):
                    setattr(self.values.header, name, chosen)
            case "dock":
                self._dock(value)
            case "current":
                self._current(value)
            case "left_out":
                self._left_out(value)
            case _:
                text = self._text(value)
                self.values.set(name, text, value, text and text.text)

    def _text(self, value: ScriptText) -> Text | None:
        said = " ".join(value.content.split())
        quoted = re.fullmatch(r'"(?:[^"\\]|\\.)*"(?:\s*"(?:[^"\\]|\\.)*")*', value.content)
        text = unquoted(value.content) if quoted else said
        if text is None:
            message = "this quoted text has an escape that does not exist"
            hint = r"write a backslash as `\\` and a quotation mark as `\"`"
            self.diagnostics.error("quoted-text", message, value.span(), hint)
            return None
        return Text(span=value.span(), text=text)

    def _nothing(self, value: ScriptText, label: ScriptText) -> None:
        types = self.understanding.types(value)
        if {*types} & {"AREA", "KIND", "HASH", "DOCK"} or {*types[:1]} & {*VERBS}:
            message = f"a field `{label.content.rstrip(' :')}` has no effect on a mission"
            hint = "write what is to be done as a sentence, or take the line out"
            self.diagnostics.error("unknown-label", message, label.span(), hint)
            return
        said = label.source.text[label.offsets[0] : value.offsets[-1] + 1]
        self.diagnostics.note("no-effect", f"`{said}` has no effect", label.span())

    def _meaning(self, name: str, value: ScriptText, kind: type[Mode] | type[Order]) -> Any:
        """What one of a few values means."""
        found = self.prose.meanings.get((name, _plain(value)))
        if found is None:
            known = {m: said for (n, said), m in reversed(self.prose.meanings.items()) if n == name}
            choices = listed((f"`{known[meaning]}`" for meaning in kind), "or")
            message = f"`{value.content}` is no {name}"
            self.diagnostics.error("field", message, value.span(), f"write {choices}")
        return found

    def is_none(self, value: ScriptText) -> bool:
        return ("none", _plain(value)) in self.prose.meanings

    def duration(self, value: ScriptText) -> None:
        """Reads the maximum duration."""
        if self.is_none(value):
            self.values.is_new("max_duration", "none", value)
            return
        found = self.understanding.words(value)
        lengths = [w for w in found if w.type in ("DURATION", "MOST_TIME")]
        others = [w for w in found if w not in lengths and w.type != "TOTAL"]
        if len(lengths) != 1 or others:
            at = _of(value, others[0]) if lengths and others else value
            message = f"`{value.content}` is no duration"
            hint = "write, say, `20 min`, `1 h 30 min` or `none`"
            self.diagnostics.error("duration", message, at.span(), hint)
            return
        (word,) = lengths
        errors = self.diagnostics.errors
        part = RulePart((word,), value, word.start, word.end, self.diagnostics)
        length = seconds(part, word)
        if self.diagnostics.errors == errors:
            node = Text(span=value.span(), text=value.content)
            self.values.set("max_duration", (length, node), value, length)

    def _place(self, name: str, value: ScriptText) -> None:
        """`docked in starting area 1 or 2`, or any other place."""
        if name == "end_of_mission" and self.is_none(value):
            chosen = AreaChosen(span=value.span(), area=None, as_planned=False)
            if self.values.is_new(name, (), value):
                self.values.header.end_area = chosen
            return
        where = self.understanding.location(value) if not self.areas.names_areas(value) else None
        if where is None or isinstance(where, tuple) or self.areas.names_dock(value):
            areas = self.areas.read(value)
            self.values.set(name, areas, value, areas and areas.areas)
            return
        if not self.values.is_new(name, _plain(value), value):
            return
        span = value.span()
        if name == "initial_position":
            order: orders.ScriptOrder = orders.Start(span=span, where=where)
            self.first.append(Sentence(span=span, orders=(order,), cases=()))
        else:
            order = orders.Go(span=span, where=where)
            self.last.append(Sentence(span=span, orders=(order,), cases=()))

    def _dock(self, value: ScriptText) -> None:
        where = None if self.is_none(value) else self.understanding.location(value)
        if where is not None and not isinstance(where, Coordinates):
            message, hint = "this field has the coordinates of a dock", "write `(3, -2.5, 0)`"
            self.diagnostics.error("field", message, value.span(), hint)
        elif where is None and not self.is_none(value):
            self._no_value(value, "write `(3, -2.5, 0) heading 90 degrees`, or `none`")
        else:
            self.values.header.dock_said, self.values.header.dock = True, where

    def _current(self, value: ScriptText) -> None:
        found = [w for w in self.understanding.words(value) if w.type != "STEP"]
        point: int | str | None = None
        if len(found) == 1 and found[0].type == "STRING":
            point = found[0].value
        elif len(found) == 1 and found[0].type == "NUMBER":
            point = found[0].value.whole
        if point is None:
            self._no_value(value, 'write a step or a name: `3`, `"MEASURE 4"`')
        else:
            self.values.set("current", Steps(span=value.span(), points=(point,)), value, point)

    def _left_out(self, value: ScriptText) -> None:
        found = [w for w in self.understanding.words(value) if not w.type.startswith("AND_")]
        names = tuple(str(w.value) for w in found if w.type == "STRING")
        if len(names) != len([w for w in found if w.type != "JOINT"]) or not names:
            self._no_value(value, 'write names in quotation marks: `"MEASURE 4", "MEASURE 8"`')
        else:
            self.values.set("left_out", names, value)

    def _no_value(self, value: ScriptText, hint: str) -> None:
        message = f"can't understand `{value.content}` here"
        self.diagnostics.error("field", message, value.span(), hint)


def _of(text: ScriptText, word: Word) -> ScriptText:
    return text[word.start : word.end]


def _plain(value: ScriptText) -> str:
    return " ".join(value.content.lower().strip(" .!").split())
