"""The fields of a header: `Maximum duration: 20'`, `Start: area 2`, and the cells of a sheet."""

import re
from typing import TYPE_CHECKING, Any

from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree.script import Areas, Header, Text
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
    "steps": r"[^:]*\bin this precise order|checkpoints(?: to (?:read|check|inspect))?",
}
_LABEL = re.compile(
    "|".join(rf"(?P<{name}>\b(?:{pattern}))\s*:" for name, pattern in _LABELS.items()),
    re.IGNORECASE,
)


_STOP = re.compile(r"[.!](?=\s|$)")
_PROSE = frozenset(
    ["designation", "anomaly_specification", "real_time_reporting", "after_mission_report"]
)


class Fields:
    """Reads fields."""

    def __init__(self, diagnostics: Diagnostics, parser: "_Parser") -> None:
        self.diagnostics = diagnostics
        self.parser = parser
        self.header = Header()

    def is_field(self, text: ScriptText) -> bool:
        """Whether a line begins with a field's label."""
        return _LABEL.match(text.content) is not None

    def read(self, text: ScriptText) -> ScriptText:
        """Reads the fields that a line begins with, perhaps several: `Start: area 2, end: area 1.`
        What is left is the rest of the line, which may have sentences."""
        while (label := _LABEL.match(text.content)) is not None:
            name = label.lastgroup
            assert name is not None
            value = text[label.end() :].strip()
            end = self._end(name, value.content)
            rest = value[end:].strip()
            field = value[: len(value.content[:end].rstrip(" ,;."))]
            if name == "steps" or not self._field(name, field):
                if "precise" in label.group().lower():
                    self.header.order = Order.PRECISE
                return value
            text = rest[len(rest.content) - len(rest.content.lstrip(" ,;.")) :]
        return text

    def _end(self, name: str, content: str) -> int:
        """Where the value of a field ends: at the next label or, unless it is prose, sentence."""
        ends = [
            m.start()
            for m in _LABEL.finditer(content)
            if content[: m.start()].rstrip()[-1:] in ",;."
        ]
        if name not in _PROSE and (stop := _STOP.search(content)):
            ends.append(stop.end())
        return min((e for e in ends if e > 0), default=len(content))

    def _field(self, name: str, value: ScriptText) -> bool:
        match name:
            case "mode":
                supervised = "superv" in value.content.lower()
                self.header.mode = Mode.SUPERVISORY if supervised else Mode.AUTONOMOUS
            case "order":
                free = "any" in value.content.lower()
                self.header.order = Order.ANY if free else Order.PRECISE
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
        self.diagnostics.error(
            "duration", f"`{value.content}` is no duration", value.span(), "write `20 min`"
        )

    def _areas(self, name: str, value: ScriptText) -> bool:
        found: list[int] = []
        listing: list[Any] = words(value.content, self.parser.language.lexicon)
        if any(w.type == "PLACE" for w in listing):
            return False
        for word in listing:
            if word.type == "NUMBER":
                found.append(int(word.value.value))
        setattr(self.header, name, Areas(span=value.span(), text=value.content, areas=tuple(found)))
        return True
