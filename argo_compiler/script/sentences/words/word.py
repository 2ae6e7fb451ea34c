"""A word of a script, as the grammar sees it."""

from typing import Any

from argo_compiler.base.records import dataclass

VERBS = (
    *("MEASURE", "KEEP_MEASURING", "GO", "HOME", "START", "START_HERE", "PATROL", "WAIT", "PAUSE"),
    *("END", "ABORT", "GO_ON", "RECHARGE", "REPORT", "REPEAT", "DO_FOLLOWING", "ADD", "DELETE"),
    *("REPLACE", "MOVE", "JUMP", "RETRY", "DOCK", "DONE", "MEET"),
    *("PARK", "SPARE", "FROM"),
)
"""terminals of the words that orders begin with"""
OPENINGS = frozenset(["IF", "IF_ONLY", "UNLESS", "UNTIL"])
"""terminals of the words that conditions begin with"""
COMPARISONS = frozenset(["GREATER", "LESS", "AT_LEAST", "AT_MOST", "BETWEEN"])
"""terminals of the words before a value in a condition"""


@dataclass(slots=True)
class Word:
    """A word, a phrase, a number or a sign, with its kind and what it means. Not frozen, for there
    are very many, and they are made faster so; nothing changes one."""

    type: str
    """the terminal of the grammar"""
    value: Any
    """what the lexicon or the figures say that it is"""
    start: int
    end: int
    """indices in the text, of the first character and behind the last"""
    before: str = ""
    """the joining signs and words that stood before it: `, and`"""

    @property
    def is_and(self) -> bool:
        return self.type == "JOINT" and self.value == "and"
