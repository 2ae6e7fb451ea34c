"""Messages in plain words for pydantic's validation errors in YAML files and options."""

import re
from collections.abc import Mapping
from typing import Any

from pydantic_core import ErrorDetails

from argo_compiler.files.json_places import JsonPath, format_path

_HAS_TO_BE = {
    "float_type": "a number",
    "float_parsing": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a mapping, with names and values",
    "model_type": "a mapping, with names and values",
    "model_attributes_type": "a mapping, with names and values",
    "greater_than": "more than {gt:g}",
    "greater_than_equal": "at least {ge:g}",
    "less_than": "less than {lt:g}",
    "less_than_equal": "at most {le:g}",
    "literal_error": "{expected}",
    "enum": "{expected}",
    "too_short": "a list of at least {min_length}",
    "too_long": "a list of at most {max_length}",
}
"""the required value, by pydantic's type of error; the error's context fills the placeholders"""


_CLOCK = re.compile(r"\d+(:\d+)+")


def error_message(error: ErrorDetails, path: JsonPath) -> str:
    """Return the message for one of pydantic's errors, about the value at a path of the file.

    Errors of types for which there is no text here keep pydantic's own.
    """
    name, kind = _name(path), error["type"]
    if kind == "missing":
        return f"{name} is missing"
    if kind == "float_parsing" and _CLOCK.fullmatch(str(error["input"])):
        return f"{name} has to be a number; times are in s, such as 90"
    if kind in _HAS_TO_BE:
        return f"{name} has to be {_HAS_TO_BE[kind].format(**error.get('ctx', {}))}"
    return error["msg"].removeprefix("Value error, ")


def _name(path: JsonPath) -> str:
    """Return the last name of a path with the indices after it, or `it` if there is none."""
    names = [k for k, step in enumerate(path) if isinstance(step, str)]
    return f"`{format_path(path[names[-1] :])}`" if names else "it"


def strip_discriminators(path: JsonPath, data: Any) -> JsonPath:
    """Return pydantic's path of an error without the discriminator values that it adds for unions.

    What remains is the path in the data. The discriminator is the field `kind`.
    """
    steps: list[int | str] = []
    for step in path:
        if isinstance(data, Mapping) and step not in data and data.get("kind") == step:
            continue
        steps.append(step)
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            data = None
    return tuple(steps)
