"""Lists as text for people."""

from collections.abc import Iterable, Sequence

from argo_compiler.base.message import Message

_SHOWN = 6
"""names of a list that a message spells out"""


def listed(items: Iterable[object], conjunction: str = "and") -> Message:
    """Return items as a message, such as `a, b and c`; empty if there are none.

    `conjunction` is `and` or `or`.
    """
    if conjunction == "or":
        return Message("{items:or}", items=tuple(items))
    return Message("{items:and}", items=tuple(items))


def brief_quoted_list(names: Sequence[str]) -> Message:
    """Return names in quotes, such as `'A', 'B' and 'C'`.

    A long list shows its first names, and the number of the others.
    """
    shown = [Message("'{name}'", name=name) for name in names[:_SHOWN]]
    if len(names) > _SHOWN:
        shown.append(Message("{more} more", more=len(names) - _SHOWN))
    return listed(shown)
