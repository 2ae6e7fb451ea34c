"""The labels of a header's fields, and what is said about one that there is not."""

import re
from dataclasses import dataclass

from argo_compiler.base.listing import listed
from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.text.spelling import candidates, nearest
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.prose import Prose

_ANY_LABEL = re.compile(r"[^\W\d_][\w'/-]*\.?(?:\s+[\w'/-]+){0,6}\s*:(?=\s|$)")
_CELLS = frozenset(
    [
        "initial_position",
        "end_of_mission",
        "anomaly_specification",
        "real_time_reporting",
        "after_mission_report",
    ]
)


@dataclass(frozen=True)
class FieldLabels:
    """Tells fields by their labels."""

    understanding: Understanding
    diagnostics: Diagnostics

    @property
    def prose(self) -> Prose:
        return self.understanding.language.prose

    def is_field(self, text: ScriptText) -> bool:
        """Whether a line begins with a field's label."""
        return self.prose.label.match(text.content) is not None

    def is_cell(self, text: ScriptText) -> bool:
        """Whether a line begins with the label of a field that may have several lines."""
        label = self.prose.label.match(text.content)
        return label is not None and label.lastgroup in _CELLS

    def relabelled(self, text: ScriptText) -> ScriptText:
        """The text with a misspelt label put right."""
        label = _ANY_LABEL.match(text.content)
        if label is None or ":" not in text.content or self.is_field(text):
            return text
        fixed, found = text, []
        for word in reversed(list(re.finditer(r"[\w'-]+", label[0]))):
            if word[0].lower() in self.prose.label_words:
                continue
            meant = candidates(word[0], self.prose.label_words)
            if len(meant) != 1:
                return text
            fixed = fixed.replace(word.start(), word.end(), meant[0])
            found.append((word[0], meant[0], text.span(word.start(), word.end())))
        if not found or not self.is_field(fixed):
            return text
        for said, meant_word, span in found:
            self.diagnostics.warning("respelled", f"read `{said}` as `{meant_word}`", span)
        return fixed

    def has_value(self, text: ScriptText) -> bool:
        """Whether a line has the shape of a field."""
        label = _ANY_LABEL.match(text.content)
        return label is not None and bool(text.content[label.end() :].strip())

    def is_unknown(self, text: ScriptText) -> bool:
        """Whether a line that makes no sense has a label that there is not; then it is said."""
        label = _ANY_LABEL.match(text.content)
        if label is None or not self.has_value(text):
            return False
        said = text[: label.end() - 1].strip()
        if {"IF", *VERBS} & {*self.understanding.types(said)}:
            return False
        close = nearest(said.content, self.prose.shown_labels, 1)
        hint = f"the fields are {listed(f'`{k}:`' for k in self.prose.shown_labels)}"
        hint = f"is `{close[0]}:` meant? {hint}" if close else hint
        self.diagnostics.error(
            "unknown-label", f"there is no field `{said.content}`", said.span(), hint
        )
        return True
