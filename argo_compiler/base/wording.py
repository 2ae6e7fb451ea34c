"""Data of a message that can be worded in another language: its template and its parameters.

A model with a text for people has the English text in a field of the type `Text`, and beside it a
field made by `wording_field`, which is None if the text is its own template.
"""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Self

from pydantic import Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from argo_compiler.base.message import Listing, Message, Parameter, as_message
from argo_compiler.base.model import Model


class _KeepsMessages:
    """Annotation of a text that may be a `Message`, which Pydantic would make a plain text."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        text = handler(source)
        kept = core_schema.is_instance_schema(Message)
        either = core_schema.union_schema([kept, text], mode="left_to_right")
        return core_schema.json_or_python_schema(
            text, either, serialization=text.get("serialization")
        )


Text = Annotated[str, _KeepsMessages()]
"""text for people, which may be a `Message`"""


class Wording(Model):
    """Template and parameters of an English text."""

    template: str
    """English text with a field in braces for each parameter; without parameters the text itself.
    The formats of fields are those of Python; `and` and `or` are formats of lists"""
    parameters: "dict[str, _WordingParameter]"
    """values by the names of the fields; a wording is a message within the message"""

    def __hash__(self) -> int:
        return hash(self.template)


_Item = str | int | float | Wording
_WordingParameter = _Item | tuple[_Item, ...]
Wording.model_rebuild()


def wording_of(text: str | None) -> Wording | None:
    """Return the wording of a text; None if it is its own template."""
    if isinstance(text, Message) and text.parameters:
        return _wording(text)
    return None


def wordings_of(texts: Iterable[str]) -> tuple[Wording | None, ...]:
    """Return the wordings of texts."""
    return tuple(map(wording_of, texts))


def wording_field(name: str) -> Any:
    """Return the field for the wording of the text, or of the texts, in the field `name` above."""

    def wording(data: dict[str, Any]) -> Wording | tuple[Wording | None, ...] | None:
        value = data.get(name)
        return wordings_of(value) if isinstance(value, tuple) else wording_of(value)

    return Field(default_factory=wording)


class Worded(Model):
    """Record with texts and their wordings, which a copy with other texts has as well."""

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        changed = dict(update or {})
        for name in [name for name in changed if f"{name}_wording" in type(self).model_fields]:
            changed.setdefault(f"{name}_wording", wording_of(changed[name]))
        return super().model_copy(update=changed, deep=deep)


def worded(text: str, wording: Wording | None) -> Message:
    """Return the message of a text whose wording was stored or sent beside it."""
    return as_message(text) if wording is None else _message(wording)


def _wording(text: Message) -> Wording:
    parameters = {name: _parameter(value) for name, value in text.parameters.items()}
    return Wording.model_construct(template=text.template, parameters=parameters)


def _parameter(value: Parameter) -> Any:
    if isinstance(value, Message):
        return _wording(value)
    return tuple(map(_parameter, value)) if isinstance(value, Listing) else value


def _message(wording: Wording) -> Message:
    restored = {name: _restored(value) for name, value in wording.parameters.items()}
    return Message(wording.template, **restored)


def _restored(value: object) -> object:
    if isinstance(value, Wording):
        return _message(value)
    return tuple(map(_restored, value)) if isinstance(value, tuple) else value
