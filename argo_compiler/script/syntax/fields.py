"""The fields of a header: `Maximum duration: 20'`, `Start: area 2`, and the cells of a sheet."""

import re
from dataclasses import dataclass

from argo_compiler.script.syntax.field_reading import PROSE_FIELDS, FieldReader
from argo_compiler.script.syntax.text.source import ScriptText
from argo_compiler.script.syntax.words.prose import Prose

_STOP = re.compile(r"[.!](?=\s|$)")
_SEPARATORS = " ,;/|"
"""between fields"""
_INITIAL = re.compile(r"\b(?:[A-Z]|Dr|Mr|Mrs|Ms)\.")
"""in a name: `J. Smith`"""
_QUOTED = re.compile(r'"(?:[^"\\]|\\.)*"(?:[\s,]*"(?:[^"\\]|\\.)*")*')


@dataclass
class ScriptFields:
    """Finds the fields of a text and has them read. Mutable: `lists` is set by one of them."""

    reader: FieldReader
    lists: bool = False
    """whether `Checkpoints:` stands above"""

    def __post_init__(self) -> None:
        self.prose = self.reader.prose

    def read(self, text: ScriptText) -> ScriptText:
        """Reads the fields that a line begins with, perhaps several: `Start: area 2, end: area 1.`
        What is left is the rest of the line, which may have sentences."""
        while (label := self.prose.label.match(text.content)) is not None:
            name = label.lastgroup
            assert name is not None
            value = text[label.end() :].strip()
            if name == "steps":
                self.lists = True
                return value
            end = _end(self.prose, name, value.content)
            rest = value[end:].strip()
            ends = _SEPARATORS if name in PROSE_FIELDS else f"{_SEPARATORS}."
            said = value[: len(value.content[:end].rstrip(ends))]
            self.reader.read(name, said, text[: label.end()])
            text = rest[len(rest.content) - len(rest.content.lstrip(f"{_SEPARATORS}.")) :]
        return text

    def behind(self, text: ScriptText) -> tuple[ScriptText, ScriptText] | None:
        """A title and the fields behind it: `Work order 12 / start: area 1`."""
        for label in self.prose.label.finditer(text.content):
            title = text.content[: label.start()].rstrip()
            if title and title[-1] in _SEPARATORS:
                return text[: len(title.rstrip(_SEPARATORS))], text[label.start() :]
        return None


def _end(prose: Prose, name: str, content: str) -> int:
    """Where the value of a field ends: at the next label or, unless it is prose, sentence;
    what stands in quotation marks is no part of either."""
    if quoted := _QUOTED.match(content):
        return quoted.end()
    ends = [
        m.start()
        for m in prose.label.finditer(content)
        if content[: m.start()].rstrip()[-1:] in (*_SEPARATORS.strip(), ".")
    ]
    if name == "nothing":
        content = _INITIAL.sub(lambda found: "x" * len(found[0]), content)
    if name not in PROSE_FIELDS and (stop := _STOP.search(content)):
        ends.append(stop.end())
    return min((e for e in ends if e > 0), default=len(content))
