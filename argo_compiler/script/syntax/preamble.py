"""Sentences that say of the mission as a whole what fields say as well: `In any order, please.`"""

import re
from dataclasses import dataclass

from argo_compiler.il import Order
from argo_compiler.script.syntax.field_reading import FieldReader
from argo_compiler.script.syntax.text.source import ScriptText
from argo_compiler.script.syntax.tree.script import Text
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.prose import begins

_WHOLE = re.compile(r"(?:(?:ANY_ORDER|THIS_ORDER|(?:MOST_TIME|WITHIN DURATION)(?: TOTAL)?) )+")
_JOINTS = frozenset(["NEXT", "JOINT", "AND_NOUN", "AND_AMOUNT", "AND_TEST", "AND_NUMBER"])
_INTRODUCTION = re.compile(
    r"(?:WORD )?(?:TO )?(?:MEASURE )?(?:ALL |THEM )?KIND (?:ANY|THIS)_ORDER "
)


@dataclass(frozen=True)
class Preamble:
    """Reads such sentences into the header's fields."""

    understanding: Understanding
    fields: FieldReader

    def introduces(self, text: ScriptText) -> bool:
        """Reads the sentence over the steps: `Control the checkpoints in this precise order:`."""
        types = self.understanding.types(text)
        if not _INTRODUCTION.fullmatch("".join(f"{type_} " for type_ in types)):
            return False
        order = Order.ANY if types[-1] == "ANY_ORDER" else Order.PRECISE
        self.fields.values.set("order", order, text)
        return True

    def leaves_open(self, text: ScriptText) -> bool:
        """Reads a sentence that leaves the docks open: `The docks are chosen on the day`."""
        said = begins(self.fields.prose.left_open).match(text.content)
        if said is None or self.fields.areas.may_ask(text[said.end() :]):
            return False
        self.fields.values.header.areas_open = Text(span=text.span(), text=text.content)
        return True

    def says_whole(self, text: ScriptText) -> bool:
        """Whether a text is about the mission as a whole, if nothing is ordered before it."""
        types = [t for t in self.understanding.types(text) if t not in _JOINTS]
        return _WHOLE.fullmatch("".join(f"{type_} " for type_ in types)) is not None

    def whole_mission(self, text: ScriptText) -> bool:
        """Reads what is said of the mission as a whole by itself: `In any order, at most 40 min`.
        False: that is not what it says."""
        if not self.says_whole(text):
            return False
        for word in self.understanding.words(text):
            if word.type in ("ANY_ORDER", "THIS_ORDER"):
                order = Order.ANY if word.type == "ANY_ORDER" else Order.PRECISE
                self.fields.values.set("order", order, text[word.start : word.end])
            elif word.type in ("DURATION", "MOST_TIME"):
                self.fields.duration(text[word.start : word.end])
        return True
