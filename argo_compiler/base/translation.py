"""Messages in German. The catalogue has a German template for each English one.

The catalogue is read when the first message is worded in German.
"""

import json
import string
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from argo_compiler.base.message import Listing, Message, joined

CATALOGUE = Path(__file__).with_name("german.json")


@cache
def german_catalogue() -> Mapping[str, str]:
    """Return the German templates by the English ones."""
    catalogue: dict[str, str] = json.loads(CATALOGUE.read_text(encoding="utf-8"))
    return catalogue


def in_german(text: str) -> str:
    """Return a text for people in German; a text that the catalogue does not have stays as it is.

    Names and other texts among the parameters of a `Message` stay as they are.
    """
    catalogue = german_catalogue()
    if not isinstance(text, Message) or not text.parameters:
        return catalogue.get(text, text)
    template = catalogue.get(text.template, text.template)
    return _FORMATTER.vformat(template, (), text.parameters)


class _GermanFormatter(string.Formatter):
    """Formatter with German numbers, lists and messages."""

    def format_field(self, value: Any, format_spec: str) -> str:
        if isinstance(value, Message):
            return in_german(value)
        if isinstance(value, Listing):
            words = [self.format_field(item, "") for item in value]
            return joined(words, _CONJUNCTIONS.get(format_spec, format_spec))
        text = format(value, format_spec)
        return text if isinstance(value, str) else _german_number(text)


_CONJUNCTIONS = {"and": "und", "or": "oder"}
_FORMATTER = _GermanFormatter()
_SWAPPED = str.maketrans(",.", ".,")


def _german_number(text: str) -> str:
    return text.translate(_SWAPPED).replace("%", " %")
