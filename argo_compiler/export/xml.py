"""Writing XML line by line: nested to any depth, and safe against any text."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from argo_compiler.base.number_text import number

_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\u007e\u0080-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_SPECIAL = {
    "&": "&amp;",
    "<": "&lt;",
    ">": "&gt;",
    '"': "&quot;",
    "\t": "&#9;",
    "\n": "&#10;",
    "\r": "&#13;",
}
_MEANS_SOMETHING = re.compile("[" + "".join(_SPECIAL) + "]")

Attributes = Mapping[str, str | int | float | None]
"""Those that are None are left out."""


class XmlWriter:
    """A document under way."""

    def __init__(self) -> None:
        self._lines = ['<?xml version="1.0" encoding="UTF-8"?>']
        self._open: list[str] = []

    def open(self, tag: str, attributes: Attributes | None = None) -> None:
        self._lines.append(f"{self._indent}<{tag}{_attributes(attributes)}>")
        self._open.append(tag)

    def close(self) -> None:
        tag = self._open.pop()
        self._lines.append(f"{self._indent}</{tag}>")

    def add(self, tag: str, attributes: Attributes | None = None) -> None:
        """An element without content."""
        self._lines.append(f"{self._indent}<{tag}{_attributes(attributes)}/>")

    def add_text(self, tag: str, text: str, attributes: Attributes | None = None) -> None:
        """An element that holds text only."""
        self._lines.append(f"{self._indent}<{tag}{_attributes(attributes)}>{escape(text)}</{tag}>")

    @contextmanager
    def element(self, tag: str, attributes: Attributes | None = None) -> Iterator[None]:
        """An element with what is written inside the block."""
        self.open(tag, attributes)
        yield
        self.close()

    def text(self) -> str:
        """The document; all elements must have been closed."""
        assert not self._open
        return "\n".join(self._lines) + "\n"

    @property
    def _indent(self) -> str:
        # Deeper than this, white space would make up most of the file.
        return "  " * min(len(self._open), 20)


def escape(text: str) -> str:
    """The text for the inside of an attribute or an element; `printable` where XML asks for it."""
    return _MEANS_SOMETHING.sub(lambda match: _SPECIAL[match[0]], printable(text))


def printable(text: str) -> str:
    """The text with what XML has no way to say (such as the null character) as `\\x00`."""
    return _NOT_IN_XML.sub(lambda match: f"\\x{ord(match[0]):02x}", text)


def _attributes(attributes: Attributes | None) -> str:
    return "".join(
        f' {name}="{escape(value if isinstance(value, str) else number(value))}"'
        for name, value in (attributes or {}).items()
        if value is not None
    )
