"""The priorities of a table: words such as `high`, or numbers.

Of numbers the smallest or the greatest may be the most important; a heading can say which.
"""

import re
from collections.abc import Sequence
from enum import Enum, auto

from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.words.prose import Prose

_NUMBER = re.compile(r"[0-9]{1,6}")
_SCALED = re.compile(
    r"(?P<heading>[^(\[:,;-]+?)[\s(\[:,;-]+(?P<number>[0-9]+)(?P<said>[^0-9]+)(?:[0-9].*)?"
)


class PriorityScale(Enum):
    """Which of the numbers is the most important."""

    OPEN = auto()
    """nothing says so"""
    SMALLEST = auto()
    GREATEST = auto()


def scale_of(heading: str, prose: Prose) -> PriorityScale | None:
    """What a heading such as `Priority (1 = highest)` says; None: it is no such heading."""
    found = _SCALED.fullmatch(heading.strip())
    if found is None or prose.column(found["heading"]) != "priority":
        return None
    highest = prose.is_highest(found["said"])
    if highest is None:
        return None
    return (
        PriorityScale.SMALLEST if highest is (int(found["number"]) <= 1) else PriorityScale.GREATEST
    )


class Priorities:
    """Tells what the cells of a column are worth. Mutable: a script may have several tables."""

    def __init__(self, prose: Prose, diagnostics: Diagnostics) -> None:
        self.prose = prose
        self.diagnostics = diagnostics
        self.scale = PriorityScale.OPEN
        self.asked = False
        self.greatest = 0

    def begin(self, scale: PriorityScale, cells: Sequence[str]) -> None:
        """Begins a table with all its cells of this column."""
        self.scale, self.asked = scale, False
        self.greatest = max((int(c) for c in cells if _NUMBER.fullmatch(c)), default=0)

    def worth(self, cell: ScriptText) -> str:
        """The priority of a cell as the sentences count them, of which the greatest is the most
        important; nothing for what is no priority. Without a scale numbers are asked about."""
        if _NUMBER.fullmatch(cell.content) is None:
            return self.prose.rank(cell.content) or ""
        number = int(cell.content)
        if self.scale is PriorityScale.OPEN and not self.asked:
            self.asked = True
            message = (
                f"`{cell.content}` can be counted from the most important one, or from the least"
            )
            hint = "write over the column `Priority (1 = highest)` or `Priority (1 = lowest)`, or "
            hint += "`high`, `medium` and `low` in it"
            self.diagnostics.error("ambiguous-priority", message, cell.span(), hint)
        return str(self.greatest + 1 - number if self.scale is PriorityScale.SMALLEST else number)
