"""Lists as text for people."""

from collections.abc import Iterable, Sequence

_SHOWN = 6
"""names of a list that a message spells out"""


def listed(items: Iterable[object], conjunction: str = "and") -> str:
    """Return items as text, such as `a, b and c`; empty if there are none."""
    words = [str(item) for item in items]
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {conjunction} {words[-1]}"


def brief_quoted_list(names: Sequence[str]) -> str:
    """Return names in quotes, such as `'A', 'B' and 'C'`.

    A long list shows its first names, and the number of the others.
    """
    shown = [f"'{name}'" for name in names[:_SHOWN]]
    if len(names) > _SHOWN:
        shown.append(f"{len(names) - _SHOWN} more")
    return listed(shown)
