"""Messages for people that can be worded in another language.

A `Message` is its English text, and keeps the template and the parameters that the text was made
from. A text without parameters is its own template, and need not be a `Message`. The template is
the key of the text in the catalogues of other languages.
"""

from collections.abc import Mapping, Sequence
from numbers import Real
from types import MappingProxyType
from typing import Any, TypeAlias

_NONE: Mapping[str, Any] = MappingProxyType({})


class Message(str):
    """English text with the template and the parameters that it was made from.

    The template must be a literal: a test reads all of them in the source. Numbers and lists
    (tuples, lists and `Listing`) are kept as such; of other objects their text is kept, and that of
    an error is a message, and so is the value of a member of an enumeration.
    """

    __slots__ = ("parameters", "template")

    template: str
    """text with a field for each parameter, such as `task '{task}' takes {seconds:.1f} s`; without
    parameters the text itself"""
    parameters: Mapping[str, "Parameter"]

    def __new__(cls, template: str, /, **parameters: object) -> "Message":
        if not parameters:
            made = super().__new__(cls, template)
            made.parameters = _NONE
        else:
            kept = {name: _kept(value) for name, value in parameters.items()}
            made = super().__new__(cls, template.format(**kept))
            made.parameters = kept
        made.template = template
        return made

    def __str__(self) -> str:
        return self

    def __add__(self, rest: str) -> "Message":
        return Message("{first}{rest}", first=self, rest=as_message(rest)) if rest else self

    def __radd__(self, first: str) -> "Message":
        return Message("{first}{rest}", first=as_message(first), rest=self) if first else self

    def __reduce__(self) -> tuple[object, ...]:
        return _message_of, (self.template, dict(self.parameters))


class Listing(tuple[Any, ...]):
    """Items of a list in a message, separated by commas.

    With the format `and` or `or` this word stands before the last item. The formats `;`, `>` and
    a space are other separators.
    """

    __slots__ = ()

    def __format__(self, format_spec: str) -> str:
        return joined([str(item) for item in self], format_spec)


Parameter: TypeAlias = str | int | float | Listing
"""value in a message; a `Message` is put into the language of the message around it, other texts
are names and stay as they are"""


_SEPARATORS = {"": ", ", ";": "; ", ">": " > ", " ": " "}


def joined(items: Sequence[str], format_spec: str) -> str:
    """Return items as one text, as the format of a `Listing` states."""
    if len(items) < 2 or format_spec in _SEPARATORS:
        return _SEPARATORS.get(format_spec, "").join(items)
    return f"{', '.join(items[:-1])} {format_spec} {items[-1]}"


def identifier(name: str) -> Message:
    """Return an identifier, such as that of a field, as a message: a catalogue may have words."""
    return Message(name)


def as_message(text: str) -> Message:
    """Return a text as a message; a text that is none yet has no parameters."""
    return text if isinstance(text, Message) else Message(text)


def _message_of(template: str, parameters: Mapping[str, "Parameter"]) -> Message:
    return Message(template, **parameters)


def _kept(value: object) -> Parameter:
    if type(value) is str or isinstance(value, Message):
        return value
    if isinstance(value, str):
        return identifier(str.__str__(value))  # a member of an enumeration
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, int | float):
        return value
    if isinstance(value, Real):  # of NumPy
        return float(value)
    if isinstance(value, Exception):
        return as_message(str(value))
    if isinstance(value, tuple | list):
        return Listing(map(_kept, value))
    return str(value)
