"""Plant tags, such as `20-PI-1034A`: letters for a kind and a number, in any spacing."""

import re

_TAG = re.compile(r"(?:[0-9]{1,3}[-_ ])?([A-Z]{1,4})[-_ ]?([0-9]{2,6})[-_ ]?([A-Z]?)")


def tag_of(text: str) -> str | None:
    """Return a tag without its unit's number and the signs between its parts: `PI1034A`; None if a
    text is no tag."""
    found = _TAG.fullmatch(text.strip())
    return None if found is None else "".join(found.groups())


def count_tag(tag: str, text: str) -> int:
    """Return how often a tag is in a text, in any spacing."""
    signs = r"[-_ ]?".join(re.escape(part) for part in re.findall(r"[A-Z]+|[0-9]+", tag))
    return len(re.findall(rf"(?<![A-Za-z0-9]){signs}(?![A-Za-z0-9])", text))
