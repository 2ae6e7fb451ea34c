"""What `reset(options=...)` and a constructor's arguments have in common: they are checked."""

from collections.abc import Iterator, Mapping, Sequence
from types import UnionType
from typing import Any, TypeVar, Union, get_args, get_origin

import numpy as np
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.files.fields import field_hint
from argo_compiler.files.json_places import format_path
from argo_env.files.yaml_messages import error_message, path_in_data

Options = TypeVar("Options", bound=Model)

LONGEST = 100_000.0
"""s that an episode may take"""


def read_options(model: type[Options], given: Any, env: str) -> Options:
    """The options as data; ArgoError that names what is wrong, and what there is. NumPy's numbers
    and arrays are as good as plain ones."""
    known = f"there are: {', '.join(model.model_fields)}"
    if not isinstance(given, Mapping):
        raise Invalid(f"options of {env} are a dictionary, not {given!r}; {known}")
    data = {name: _plain(value) for name, value in given.items()}
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = _meant(model, error.errors(include_url=False))
        wrong = "; ".join(_said(model, one, data) for one in found)
        raise Invalid(f"options of {env}: {wrong}; {known}") from None


def check_scenario(env: str, scenario: Any) -> None:
    """Raises ArgoError if it can't be the name of a site."""
    if not isinstance(scenario, str):
        raise Invalid(f"{env}: `scenario` is {scenario!r}, and has to be the name of a site")


def check_floors(scenario: str, known: Sequence[int], floors: Sequence[int]) -> None:
    """Raises ArgoError for the first of the floors that is not among the known ones."""
    for floor in floors:
        if floor not in known:
            last, row = known[-1], list(known) == list(range(known[0], known[-1] + 1))
            said = f"{known[0]} to {last}" if row else ", ".join(map(str, known))
            there = f"the floors {said}" if len(known) > 1 else f"floor {last} only"
            raise NotFound(f"scenario {scenario} has {there}, not {floor}")


def check_positive(env: str, most: float, **arguments: Any) -> None:
    """Raises ArgoError for the first argument that is no number above 0 and up to `most`."""
    for name, value in arguments.items():
        number = isinstance(value, int | float | np.integer | np.floating)
        if isinstance(value, bool) or not (number and 0 < value <= most):
            raise Invalid(
                f"{env}: `{name}` is {value!r}, and has to be a number of more than 0, and at most "
                f"{most:.0f}"
            )


def check_whole(env: str, low: int, high: int, why: str = "", **arguments: Any) -> None:
    """Raises ArgoError for the first argument that is no whole number from `low` to `high`; `why`
    says more about the least value."""
    for name, value in arguments.items():
        whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not (whole and value >= low):
            raise Invalid(
                f"{env}: `{name}` is {value!r}, and has to be a whole number of at least {low}{why}"
            )
        if value > high:
            raise Invalid(f"{env}: `{name}` is {value!r}, and has to be at most {high}")


def _plain(value: Any) -> Any:
    """The value without NumPy's types."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [_plain(part) for part in value] if isinstance(value, list | tuple) else value


def _said(model: type[Model], error: ErrorDetails, data: Any) -> str:
    """Where it is wrong, what is wrong, and what to do about it."""
    path = path_in_data(error["loc"], data)
    place, context = f"`{format_path(path)}`", error.get("ctx", {})
    if error["type"] == "extra_forbidden":
        return f"{place}: there is no such option ({field_hint(model, error['loc'])})"
    if error["type"] == "union_tag_not_found":
        return f"{place}: it has no `kind`"
    if error["type"] == "union_tag_invalid":
        return f"{place}: no kind `{context['tag']}`, only {context['expected_tags']}"
    return f"{place}: {error_message(error, path)}"


def _meant(model: type[Model], errors: list[ErrorDetails]) -> Iterator[ErrorDetails]:
    """The errors; of an option that may be of several types, those of the type that was meant."""
    choices: dict[int | str, list[ErrorDetails]] = {}
    for error in errors:
        name, *rest = error["loc"]
        field = model.model_fields.get(str(name))
        if field is None or not _is_choice(field.annotation):
            yield error
            continue
        inner = error.copy()
        inner["loc"] = (name, *rest[1:])  # less pydantic's name for the type
        choices.setdefault(name, []).append(inner)
    for found in choices.values():
        fit = [e for e in found if len(e["loc"]) > 1 or not _is_of_another_type(e)]
        if fit:
            yield from fit
            continue
        # No type fits: "has to be a whole number, or a list".
        both = found[0].copy()
        said = [error_message(e, e["loc"]) for e in found]
        both["type"] = "choice"
        both["msg"] = ", or ".join([said[0], *(s.rpartition("has to be ")[2] for s in said[1:])])
        yield both


def _is_choice(annotation: Any) -> bool:
    """Whether it is a union of types, None not counted."""
    kinds = [kind for kind in get_args(annotation) if kind is not type(None)]
    return get_origin(annotation) in {Union, UnionType} and len(kinds) > 1


def _is_of_another_type(error: ErrorDetails) -> bool:
    return error["type"].endswith(("_type", "_parsing")) or error["type"] == "int_from_float"
