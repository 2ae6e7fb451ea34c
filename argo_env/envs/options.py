"""Checks of options of `reset(options=...)` and of constructors' arguments."""

from collections.abc import Iterator, Mapping, Sequence
from types import UnionType
from typing import Any, TypeVar, Union, get_args, get_origin

import numpy as np
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.files.fields import unknown_field_hint
from argo_compiler.files.json_places import format_path
from argo_env.files.yaml_messages import error_message, strip_discriminators

Options = TypeVar("Options", bound=Model)

MAX_DURATION = 100_000.0
"""longest time (s) that an argument or an option may state"""


def options_from_dict(model: type[Options], given: Any, env: str) -> Options:
    """Return the options of a `reset` as an object of `model`.

    NumPy's numbers and arrays are converted. Raises ArgoError if `given` is no dictionary or does
    not fit the model; the message names the wrong options and the available ones.
    """
    known = f"available options: {', '.join(model.model_fields)}"
    if not isinstance(given, Mapping):
        raise Invalid(f"the options of {env} are a dictionary, not {given!r}; {known}")
    data = {name: _without_numpy(value) for name, value in given.items()}
    try:
        return model.model_validate(data)
    except ValidationError as error:
        errors = _relevant_errors(model, error.errors(include_url=False))
        wrong = "; ".join(_describe_error(model, one, data) for one in errors)
        raise Invalid(f"wrong options of {env}: {wrong}; {known}") from None


def check_scenario_is_string(env: str, scenario: Any) -> None:
    """Raise ArgoError if `scenario` is not a string, and so not the name of a site.

    It is not checked that there is such a site.
    """
    if not isinstance(scenario, str):
        raise Invalid(f"{env}: `scenario` is {scenario!r}, and has to be the name of a site")


def check_floors(scenario: str, known: Sequence[int], floors: Sequence[int]) -> None:
    """Raise ArgoError if one of `floors` is not among the `known` ones of the scenario."""
    for floor in floors:
        if floor not in known:
            last, row = known[-1], list(known) == list(range(known[0], known[-1] + 1))
            listed = f"{known[0]} to {last}" if row else ", ".join(map(str, known))
            available = f"the floors {listed}" if len(known) > 1 else f"floor {last} only"
            raise NotFound(f"scenario {scenario} has {available}, not {floor}")


def check_positive(env: str, maximum: float, **arguments: Any) -> None:
    """Raise ArgoError if a named argument is not a number above 0 and up to `maximum`."""
    for name, value in arguments.items():
        number = isinstance(value, int | float | np.integer | np.floating)
        if isinstance(value, bool) or not (number and 0 < value <= maximum):
            raise Invalid(
                f"{env}: `{name}` is {value!r}, and has to be a number of more than 0, and at most "
                f"{maximum:.0f}"
            )


def check_integer(env: str, low: int, high: int, reason: str = "", **arguments: Any) -> None:
    """Raise ArgoError if a named argument is not a whole number from `low` to `high`.

    The message about a number that is too low ends with `reason`, which follows the value of `low`.
    """
    for name, value in arguments.items():
        whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not (whole and value >= low):
            raise Invalid(
                f"{env}: `{name}` is {value!r}, and has to be a whole number of at least "
                f"{low}{reason}"
            )
        if value > high:
            raise Invalid(f"{env}: `{name}` is {value!r}, and has to be at most {high}")


def _without_numpy(value: Any) -> Any:
    """Return the value without NumPy's types."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [_without_numpy(part) for part in value] if isinstance(value, list | tuple) else value


def _describe_error(model: type[Model], error: ErrorDetails, data: Any) -> str:
    """Return the place of an error, what is wrong there, and the remedy."""
    path = strip_discriminators(error["loc"], data)
    place, context = f"`{format_path(path)}`", error.get("ctx", {})
    if error["type"] == "extra_forbidden":
        return f"{place}: there is no such option ({unknown_field_hint(model, error['loc'])})"
    if error["type"] == "union_tag_not_found":
        return f"{place}: it has no `kind`"
    if error["type"] == "union_tag_invalid":
        return f"{place}: no kind `{context['tag']}`, only {context['expected_tags']}"
    return f"{place}: {error_message(error, path)}"


def _relevant_errors(model: type[Model], errors: list[ErrorDetails]) -> Iterator[ErrorDetails]:
    """Yield the errors; of an option with several types, only those of the intended type."""
    choices: dict[int | str, list[ErrorDetails]] = {}
    for error in errors:
        name, *rest = error["loc"]
        field = model.model_fields.get(str(name))
        if field is None or not _is_union(field.annotation):
            yield error
            continue
        inner = error.copy()
        inner["loc"] = (name, *rest[1:])  # without pydantic's name of the type
        choices.setdefault(name, []).append(inner)
    for group in choices.values():
        fitting = [e for e in group if len(e["loc"]) > 1 or not _is_type_error(e)]
        if fitting:
            yield from fitting
            continue
        # No type fits: "has to be a whole number, or a list".
        combined = group[0].copy()
        messages = [error_message(e, e["loc"]) for e in group]
        combined["type"] = "choice"
        combined["msg"] = ", or ".join(
            [messages[0], *(s.rpartition("has to be ")[2] for s in messages[1:])]
        )
        yield combined


def _is_union(annotation: Any) -> bool:
    """Return True if the annotation is a union of types, not counting None."""
    kinds = [kind for kind in get_args(annotation) if kind is not type(None)]
    return get_origin(annotation) in {Union, UnionType} and len(kinds) > 1


def _is_type_error(error: ErrorDetails) -> bool:
    return error["type"].endswith(("_type", "_parsing")) or error["type"] == "int_from_float"
