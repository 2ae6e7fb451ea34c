"""Plant tags, such as `20-PI-1034A`: letters for a kind and a number, in any spacing, with or
without the number of a unit before them."""

import re
from typing import NamedTuple

_TAG = (
    r"(?:(?P<unit>[0-9]{1,3})[-_ ]?)?"
    r"(?P<letters>[A-Z]{1,4})[-_ ]?(?P<number>[0-9]{2,6})(?:[-_ ]?(?P<end>[A-Z]))?"
)
_WHOLE = re.compile(_TAG)
TAGS = re.compile(rf"(?<![\w#.-]){_TAG}(?![\w-])")


class Tag(NamedTuple):
    """A tag without the signs between its parts."""

    unit: str
    name: str
    """letters and number: `PI1034A`"""

    @property
    def whole(self) -> str:
        return self.unit + self.name


def tag_of(text: str) -> Tag | None:
    """Return the tag that a text is; None if it is none."""
    found = _WHOLE.fullmatch(text.strip())
    return None if found is None else tag_from(found)


def tag_from(found: re.Match[str]) -> Tag:
    """Return the tag of a match of `TAGS`."""
    name = f"{found['letters']}{found['number']}{found['end'] or ''}"
    return Tag(found["unit"] or "", name)


def count_tag(tag: Tag, text: str) -> int:
    """Return how often a tag is in a text, in any spacing."""
    return sum(tag_from(found).name == tag.name for found in TAGS.finditer(text))
