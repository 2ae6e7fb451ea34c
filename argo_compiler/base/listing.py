"""Lists in words."""

from collections.abc import Iterable, Sequence

_SHOWN = 6
"""names of a list that a message spells out"""


def listed(items: Iterable[object], conjunction: str = "and") -> str:
    """`a, b and c`; empty if there is nothing."""
    words = [str(item) for item in items]
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {conjunction} {words[-1]}"


def quoted(names: Sequence[str]) -> str:
    """Names in quotes: `'A', 'B' and 'C'`, the rest of a long list only counted."""
    shown = [f"'{name}'" for name in names[:_SHOWN]]
    if len(names) > _SHOWN:
        shown.append(f"{len(names) - _SHOWN} more")
    return listed(shown)
