"""XML writer that works line by line, with any depth of nesting and any text."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from argo_compiler.base.number_text import number_text

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
_SPECIAL_CHARACTER = re.compile("[" + "".join(_SPECIAL) + "]")

Attributes = Mapping[str, str | int | float | None]
"""Attributes of an element by name; an attribute whose value is None is left out."""


class XmlWriter:
    """XML document that grows line by line; holds the lines and the open elements."""

    def __init__(self) -> None:
        self._lines = ['<?xml version="1.0" encoding="UTF-8"?>']
        self._open: list[str] = []

    def open(self, tag: str, attributes: Attributes | None = None) -> None:
        """Open an element, which `close` closes."""
        self._lines.append(f"{self._indent}<{tag}{_attributes(attributes)}>")
        self._open.append(tag)

    def close(self) -> None:
        """Close the element that was opened last."""
        tag = self._open.pop()
        self._lines.append(f"{self._indent}</{tag}>")

    def add(self, tag: str, attributes: Attributes | None = None) -> None:
        """Add an element without content."""
        self._lines.append(f"{self._indent}<{tag}{_attributes(attributes)}/>")

    def add_text(self, tag: str, text: str, attributes: Attributes | None = None) -> None:
        """Add an element that holds only text."""
        self._lines.append(f"{self._indent}<{tag}{_attributes(attributes)}>{escape(text)}</{tag}>")

    @contextmanager
    def nest_in(self, tag: str, attributes: Attributes | None = None) -> Iterator[None]:
        """Open an element for the duration of the `with` block, and close it afterwards."""
        self.open(tag, attributes)
        yield
        self.close()

    def text(self) -> str:
        """Return the document; all elements must have been closed."""
        assert not self._open
        return "\n".join(self._lines) + "\n"

    @property
    def _indent(self) -> str:
        # With deeper indentation, white space would make up most of the file.
        return "  " * min(len(self._open), 20)


def escape(text: str) -> str:
    """Return the text escaped for an attribute or an element; its forbidden characters as well."""
    return _SPECIAL_CHARACTER.sub(
        lambda match: _SPECIAL[match[0]], escape_forbidden_characters(text)
    )


def escape_forbidden_characters(text: str) -> str:
    r"""Return the text with an escape for each character that XML forbids: for null, `\x00`."""
    return _NOT_IN_XML.sub(lambda match: f"\\x{ord(match[0]):02x}", text)


def _attributes(attributes: Attributes | None) -> str:
    return "".join(
        f' {name}="{escape(value if isinstance(value, str) else number_text(value))}"'
        for name, value in (attributes or {}).items()
        if value is not None
    )
