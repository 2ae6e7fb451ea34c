"""What is wrong with a value of a YAML file or of options, in plain words, and where."""

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
"""By pydantic's types of errors, with what is in their context."""


def message_of(error: ErrorDetails, path: JsonPath) -> str:
    """What is wrong with the value at a path of the file."""
    name, kind = _name(path), error["type"]
    if kind == "missing":
        return f"{name} is missing"
    if kind in _HAS_TO_BE:
        return f"{name} has to be {_HAS_TO_BE[kind].format(**error.get('ctx', {}))}"
    return error["msg"].removeprefix("Value error, ")


def _name(path: JsonPath) -> str:
    """The last name of a path, with the numbers after it."""
    names = [k for k, step in enumerate(path) if isinstance(step, str)]
    return f"`{format_path(path[names[-1] :])}`" if names else "it"


def path_in_data(path: JsonPath, data: Any) -> JsonPath:
    """The path without the kinds of things that a choice was made among, which pydantic adds."""
    found: list[int | str] = []
    for step in path:
        if isinstance(data, Mapping) and step not in data and data.get("kind") == step:
            continue
        found.append(step)
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            data = None
    return tuple(found)
