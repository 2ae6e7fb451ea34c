"""Fields that name starting areas: `docked in "Starting area" 1 or 2, chosen by the staff`."""

import re
from collections.abc import Iterator

from argo_compiler.script.syntax.asides import Asides
from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree.script import AreaChosen, Areas
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.lexicon import expand
from argo_compiler.script.syntax.words.word import Word

_TOKEN = re.compile(r"[\w'-]+")
_BRIDGES = ("AND_", "OR_", "JOINT")


class AreaCells:
    """Reads such fields. Words that say no more than that it is an area are passed over; what
    stands behind a comma and asks for nothing is a note, and anything else an error."""

    def __init__(
        self, understanding: Understanding, asides: Asides, diagnostics: Diagnostics
    ) -> None:
        self.understanding = understanding
        self.asides = asides
        self.diagnostics = diagnostics
        self.prose = understanding.language.prose

    def names_areas(self, value: ScriptText) -> bool:
        return bool(list(self._areas(self.understanding.words(value))))

    def names_dock(self, value: ScriptText) -> bool:
        return any(word.type == "DOCK" for word in self.understanding.words(value))

    def read(self, value: ScriptText) -> Areas | None:
        """The areas that a field offers; more than one leaves the choice open."""
        errors = self.diagnostics.errors
        found = list(self._areas(self.understanding.words(value)))
        covered = [span for _, span in found]
        areas: list[int] = []
        for word, _ in found:
            number = word.value.whole
            if number is None or number > 9999:
                said = value[word.start : word.end]
                message = f"`{said.content}` is no number of a starting area"
                self.diagnostics.error("number", message, said.span(), "write, say, `area 1`")
            else:
                areas.append(number)
        last = max((end for _, end in covered), default=0)
        tail = value.content.find(",", last)
        if tail > 0 and not self.may_ask(value[tail + 1 :].strip()):
            aside = value[tail + 1 :].strip()
            if aside.content:
                message = f"`{aside.content}` has no effect"
                self.diagnostics.note("no-effect", message, aside.span())
        else:
            tail = len(value.content)
        self._refuse_strays(value, tail, covered)
        if self.diagnostics.errors > errors:
            return None
        at = value[found[0][0].start : found[0][0].end] if found else value
        return Areas(span=at.span(), text=value.content, areas=tuple(areas))

    def may_ask(self, aside: ScriptText) -> bool:
        """Whether words behind an area may change what it means."""
        types = {*self.understanding.types(aside)}
        return bool(types & {"NOT", "IF", "IF_ONLY", "UNLESS", "EXCEPT", "AREA", "NUMBER", "ELSE"})

    def _refuse_strays(self, value: ScriptText, end: int, covered: list[tuple[int, int]]) -> None:
        around = frozenset(expand(self.prose.around_areas))
        for token in _TOKEN.finditer(value.content, 0, end):
            said = token[0].lower()
            if any(a <= token.start() < b for a, b in covered):
                continue
            joins = said in self.understanding.joints("or")
            if said not in around and not (joins and any(a > token.start() for a, _ in covered)):
                span = value.span(token.start(), token.end())
                message = f"can't understand `{token[0]}` here"
                hint = "write, say, `docked in starting area 1`, or `starting area 1 or 2`"
                self.diagnostics.error("not-understood", message, span, hint)
                return

    def _areas(self, found: list[Word]) -> Iterator[tuple[Word, tuple[int, int]]]:
        """The numbers of areas, with what of the text each covers."""
        inside = False
        start = 0
        for i, word in enumerate(found):
            if word.type == "AREA":
                inside, start = True, word.start
            elif word.type == "NUMBER" and (inside or len(found) == 1 or _only_numbers(found)):
                yield word, (start if inside else word.start, word.end)
                inside, start = True, word.end
            elif not word.type.startswith(_BRIDGES) or i + 1 == len(found):
                inside = False

    def chosen(self, value: ScriptText) -> AreaChosen | None:
        """`1`, `none`, `1, as planned`."""
        said, comma, behind = value.content.partition(",")
        planned = ("as_planned", behind.strip().lower()) in self.prose.meanings
        number = re.fullmatch(
            r"(?:(?:(?:starting )?area|startbereich)\s+)?([0-9]{1,4})", said.strip().lower()
        )
        none = ("none", said.strip().lower()) in self.prose.meanings
        if (number is None and not none) or bool(comma) != planned:
            message = f"can't understand `{value.content}` here"
            hint = "write the area's number, or `none`, and perhaps `, as planned` behind it"
            self.diagnostics.error("field", message, value.span(), hint)
            return None
        area = int(number[1]) if number is not None else None
        return AreaChosen(span=value.span(), area=area, as_planned=planned)


def _only_numbers(found: list[Word]) -> bool:
    return all(word.type == "NUMBER" or word.type.startswith(_BRIDGES) for word in found)
