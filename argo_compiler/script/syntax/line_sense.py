"""Whether the lines of a script make sense: by themselves, or with the line below."""

import re
from dataclasses import dataclass, field

from argo_compiler.script.syntax.asides import Asides
from argo_compiler.script.syntax.grammar.parser import StumbleError
from argo_compiler.script.syntax.labels import FieldLabels
from argo_compiler.script.syntax.sentence_ends import sentences
from argo_compiler.script.syntax.text.source import ScriptText
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.joints import VERBS

_OPENERS = frozenset([*VERBS, "IF", "UNLESS", "ELSE"]) - {"DOCK", "FROM"}
_WORD = re.compile(r"\w+")
_END = 80
"""characters at the end of a text that tell whether it goes on"""
_LONGEST_MENDED = 300
"""characters of a sentence that is mended to see whether it makes sense"""


@dataclass(frozen=True)
class LineSense:
    """Tells what lines make sense, and how."""

    understanding: Understanding
    asides: Asides
    labels: FieldLabels
    one: dict[tuple[object, ...], bool] = field(default_factory=dict)
    """whether two lines, one below the other, are one text; many are alike"""

    def stands_alone(self, text: ScriptText) -> bool:
        """Whether a line never goes on with the one above it."""
        content = text.content
        asides = self.asides
        numbered = content[-1:].isdigit() and asides.is_explicit_title(text)
        alone = numbered or asides.is_remark(content) or asides.opens(content)
        return alone or self.labels.is_field(text)

    def announces(self, text: ScriptText) -> bool:
        """Whether a text says that lines below it are to be done: `Do the following twice:`."""
        listed = text.content.endswith(":")
        types = {*self.understanding.types(text)} if listed else set()
        return "DO_FOLLOWING" in types and not types & {"MEASURE", "KIND"}

    def is_complete(self, text: ScriptText) -> bool:
        """Whether a text makes sense by itself."""
        if self.labels.is_field(text):
            return True
        return all(self._fits(sentence) for sentence in sentences(text))

    def is_unfinished(self, text: ScriptText) -> bool:
        """Whether a text plainly goes on: after a comma, `and` or `, then`."""
        text = text[-_END:]
        if text.content.endswith((",", '":')) or self.understanding.unfinished(text) is not None:
            return True
        found = self.understanding.words(text)
        behind = text[found[-1].end :] if found else text[:0]
        return "," in behind.content or any(
            self.understanding.unfinished(behind[: word.end()]) is not None
            for word in _WORD.finditer(behind.content)
        )

    def opens_sentence(self, text: ScriptText) -> bool:
        """Whether a text begins as a sentence of its own does."""
        types = self.understanding.types(text)
        opens = bool(types) and types[0] in _OPENERS
        return opens and (text.content[0].isupper() or self.is_complete(text))

    def begins_with_joint(self, text: ScriptText) -> bool:
        """Whether a text begins with `and` or the like."""
        found = self.understanding.words(text)
        first = found[0] if found else None
        return first is not None and (
            first.type[:3] == "OR_" or any(map(str.isalpha, first.before))
        )

    def is_fragment(self, text: ScriptText, indented: bool) -> bool:
        """Whether a text that makes no sense by itself is no heading or remark, either."""
        beginning = indented or not text.content[0].isupper()
        ended = text.content.endswith(":") or self.asides.is_small_talk(text)
        return beginning and not ended

    def is_beginning(self, text: ScriptText, ended: bool) -> bool:
        """Whether a text is how a sentence begins; the whole of one where it has ended."""
        if ended:
            return not isinstance(self.understanding.read(text), StumbleError)
        types = self.understanding.types(text)
        return "WORD" not in types and self.understanding.grammar.begins(types)

    def _fits(self, sentence: ScriptText) -> bool:
        understanding = self.understanding
        return understanding.fits(sentence) or (
            len(sentence.content) <= _LONGEST_MENDED
            and "WORD" in understanding.types(sentence)
            and understanding.respelled(sentence, quiet=True) is not None
        )
