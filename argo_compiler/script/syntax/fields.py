"""The fields of a header: `Maximum duration: 20'`, `Start: area 2`, and the cells of a sheet."""

import re
from typing import TYPE_CHECKING, Any

from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree.script import AreaChosen, Areas, Header, Text
from argo_compiler.script.syntax.words.lengths import Length
from argo_compiler.script.syntax.words.lexer import words

if TYPE_CHECKING:
    from argo_compiler.script.syntax.parsing import _Parser

_LABELS = {
    "designation": r"(?:mission's |mission )?designation",
    "mode": r"(?:main )?mode",
    "site": r"site",
    "max_duration": r"max(?:imum)?(?: mission)?(?: total)?(?: mission)? (?:duration|time)",
    "order": r"order",
    "anomaly_specification": r"anomaly specification",
    "real_time_reporting": r"real[- ]time reporting",
    "after_mission_report": r"after[- ]mission report(?:ing)?",
    "initial_position": r"initial position|start(?:ing)?(?: (?:area|position))?",
    "end_of_mission": r"end of (?:the )?mission|end(?: area)?|finish",
    "steps": r".*\bin this precise order|checkpoints(?: to (?:read|check|inspect))?",
}
_LABEL = {name: re.compile(rf"(?:{pattern})\s*:\s*", re.IGNORECASE) for name, pattern in _LABELS.items()}


class Fields:
    """Reads fields."""

    def __init__(self, diagnostics: Diagnostics, parser: "_Parser") -> None:
        self.diagnostics = diagnostics
        self.parser = parser
        self.header = Header()

    def label(self, text: ScriptText) -> tuple[str, int] | None:
        """The field that a line begins with, and where its value begins."""
        for name, pattern in _LABEL.items():
            if found := pattern.match(text.content):
                return name, found.end()
        return None

    def read(self, text: ScriptText) -> bool:
        """Reads a line if it is a field."""
        found = self.label(text)
        if found is None:
            return False
        name, at = found
        value = text[at:].strip()
        match name:
            case "steps":
                if "precise" in text.content.lower():
                    self.header.order = Order.PRECISE
                return not value.content
            case "mode":
                self.header.mode = Mode.SUPERVISORY if "superv" in value.content.lower() else Mode.AUTONOMOUS
            case "order":
                self.header.order = Order.ANY if "any" in value.content.lower() else Order.PRECISE
            case "max_duration":
                self._duration(value)
            case "initial_position" | "end_of_mission":
                return self._areas(name, value)
            case _:
                setattr(self.header, name, Text(span=value.span(), text=value.content))
        return True

    def _duration(self, value: ScriptText) -> None:
        for word in words(value.content, self.parser.language.lexicon):
            if word.type == "DURATION" and isinstance(word.value, Length):
                node = Text(span=value.span(), text=value.content)
                self.header.max_duration = (word.value.seconds, node)
                return
        self.diagnostics.error("duration", f"`{value.content}` is no duration", value.span(), "write `20 min`")

    def _areas(self, name: str, value: ScriptText) -> bool:
        found: list[int] = []
        listing: list[Any] = words(value.content, self.parser.language.lexicon)
        if any(w.type == "PLACE" for w in listing):
            return False
        for word in listing:
            if word.type == "NUMBER":
                found.append(int(word.value.value))
        if len(found) == 1 and False:
            setattr(self.header, name, AreaChosen(span=value.span(), area=found[0], as_planned=False))
        setattr(self.header, name, Areas(span=value.span(), text=value.content, areas=tuple(found)))
        return True
