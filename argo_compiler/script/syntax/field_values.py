"""The values of a header, each said once, or the same each time."""

from dataclasses import dataclass, field
from typing import Any

from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree.script import ScriptHeader


@dataclass
class FieldValues:
    """What the fields said so far. Mutable: the header grows field by field."""

    diagnostics: Diagnostics
    header: ScriptHeader = field(default_factory=ScriptHeader)
    _said: dict[str, tuple[Any, ScriptText]] = field(default_factory=dict)
    """what the fields say, and where"""

    def set(self, name: str, meaning: Any, value: ScriptText, key: Any = None) -> None:
        """Keeps a field, unless it stands elsewhere with another value; None: it has an error.
        The key is what tells two values apart, where the meaning has its place in it."""
        if meaning is not None and self.is_new(name, meaning if key is None else key, value):
            setattr(self.header, name, meaning)

    def is_new(self, name: str, key: Any, value: ScriptText) -> bool:
        """Whether a field is said for the first time; another value than before is an error."""
        known, before = self._said.setdefault(name, (key, value))
        if known == key:
            return before is value
        line = before.span().line
        message = f"line {line} says `{before.content}`, and this says `{value.content}`"
        hint = "leave one of the two out"
        self.diagnostics.error("repeated-field", message, value.span(), hint)
        return False
