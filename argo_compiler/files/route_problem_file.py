"""JSON files of route problems and of suggested routes, for other programs and for later use.

A problem is an object with `version` 1 and the fields of `RouteProblem`. A matrix is a list of
rows, where `null` stands for NEVER. Fields with their default value may be omitted.
"""

import json
from collections.abc import Mapping
from dataclasses import MISSING, asdict, fields
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError, create_model

from argo_compiler.base.errors import Invalid, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.files.json_places import (
    LONG_NUMBER,
    JsonPath,
    JsonText,
    find_places_or_parents,
    format_path,
)
from argo_compiler.files.loading import decode_text, read_bytes
from argo_compiler.route.problem import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    Visit,
)
from argo_compiler.route.suggested import RouteSuggestion

VERSION = 1
MAX_BYTES = 200_000_000
"""Limit far above the size of a problem with 3,000 visits."""

_Rows = tuple[tuple[int | None, ...], ...]


def _model(data: type, **json_types: Any) -> type[BaseModel]:
    """Return a pydantic model of the JSON object that a dataclass is written as.

    `json_types` are the types of fields that differ in JSON from those of the dataclass.
    """
    hints = {**get_type_hints(data), **json_types}
    defaults = {
        f.name: f.default_factory() if f.default_factory is not MISSING else f.default
        for f in fields(data)
    }
    content = {
        name: (hint, ... if defaults.get(name, MISSING) is MISSING else defaults[name])
        for name, hint in hints.items()
    }
    config = ConfigDict(extra="forbid", strict=True)
    return create_model(data.__name__, __config__=config, **content)  # type: ignore[call-overload,no-any-return]


_VISIT, _PRECEDENCE, _ROUND = _model(Visit), _model(Precedence), _model(Round)
_BATTERY = _model(EnergyBudget, energy=_Rows)
_PROBLEM = _model(
    RouteProblem,
    version=int,
    visits=tuple[_VISIT, ...],  # type: ignore[valid-type]
    travel=_Rows,
    precedences=tuple[_PRECEDENCE, ...],  # type: ignore[valid-type]
    rounds=tuple[_ROUND, ...],  # type: ignore[valid-type]
    battery=_BATTERY | None,
    words=dict[str, str],
)


def write_route_problem(problem: RouteProblem, path: Path) -> None:
    """Write a problem as JSON. Raises Unavailable if the file can't be written."""
    try:
        write_atomically(path, route_problem_text(problem))
    except OSError as error:
        raise Unavailable(
            Message("{path} can't be written: {reason}", path=path, reason=reason_text(error))
        ) from error


def route_problem_text(problem: RouteProblem) -> str:
    """Return the text that `write_route_problem` writes."""
    values = {field.name: _json_value(getattr(problem, field.name)) for field in fields(problem)}
    needed = {name: value for name, value in values.items() if value not in (None, [], {})}
    return json.dumps({"version": VERSION, "visits": [], **needed}, ensure_ascii=False) + "\n"


def _json_value(value: Any) -> Any:
    """Return the value of a problem's field as a value that JSON can represent."""
    if isinstance(value, np.ndarray):
        return [[None if time == NEVER else time for time in row] for row in value.tolist()]
    if isinstance(value, EnergyBudget):
        return {f.name: _json_value(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, tuple):
        return [item if isinstance(item, str) else asdict(item) for item in value]
    return dict(value) if isinstance(value, Mapping) else value


def read_route_problem(path: Path) -> RouteProblem:
    """Return the problem in a JSON file.

    Raises FileError, or Invalid with the place in the file.
    """
    content = read_bytes(path, Message("file of a route problem"), MAX_BYTES)
    return parse_route_problem(
        decode_text(content, path, Message("file of a route problem")), str(path)
    )


def parse_route_problem(text: str, name: str) -> RouteProblem:
    """Return the problem in a JSON text, which messages call `name`. Raises Invalid."""
    try:
        data = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        where = f"{error.lineno}:{error.colno}:" if isinstance(error, json.JSONDecodeError) else ""
        what = getattr(error, "msg", Message("it is nested too deeply"))
        raise Invalid(
            Message(
                "{name}:{where} the text is not JSON: {what}; correct it there",
                name=name,
                where=where,
                what=what,
            )
        ) from error
    except ValueError as error:
        raise Invalid(
            Message(
                "{name} can't be read: {long_number}; correct it",
                name=name,
                long_number=LONG_NUMBER,
            )
        ) from error
    version = data.get("version") if isinstance(data, dict) else None
    if version != VERSION or isinstance(version, bool):
        raise Invalid(
            Message(
                "{name} is not a route problem of version {version}, which begins with "
                '{{"version": {version}, "visits": [; write it again with this version of '
                "Argo",
                name=name,
                version=VERSION,
            )
        )
    try:
        model = _PROBLEM.model_validate_json(text)
    except ValidationError as error:
        raise Invalid(Message("{name}{fault}", name=name, fault=_fault_text(error, text))) from None
    try:
        return _to_problem(model)
    except Invalid as error:
        raise Invalid(Message("{name}: {error}", name=name, error=error)) from None


def _fault_text(error: ValidationError, text: str) -> str:
    """Return the first error as text with line, column and path: `:3:7: visits[0].prize: …`."""
    first = error.errors(include_url=False)[0]
    path: JsonPath = first["loc"]
    owner = path[:-1] if first["type"] in {"missing", "extra_forbidden"} else path
    span = find_places_or_parents(JsonText(text), [owner]).get(owner) if owner else None
    place = f":{span.line}:{span.column}" if span else ""
    what = first["msg"][:1].lower() + first["msg"][1:]
    if first["type"] == "extra_forbidden":
        nearest = nearest_name(str(path[-1]), tuple(_PROBLEM.model_fields))
        what = (
            Message("there is no such field; is `{nearest}` meant?", nearest=nearest)
            if nearest
            else Message("there is no such field")
        )
    more = len(error.errors()) - 1
    return f"{place}: {format_path(path)}: {what}" + (
        Message(" (and {more} more)", more=more) if more else ""
    )


def _to_problem(model: Any) -> RouteProblem:
    battery = model.battery
    return RouteProblem(
        tuple(Visit(**visit.model_dump()) for visit in model.visits),
        _matrix(model.travel, "travel"),
        tuple(Precedence(**pair.model_dump()) for pair in model.precedences),
        tuple(Round(**round.model_dump()) for round in model.rounds),
        model.max_duration,
        None
        if battery is None
        else EnergyBudget(
            _matrix(battery.energy, "battery.energy"),
            battery.capacity,
            battery.used,
            battery.overhead,
        ),
        model.chargers,
        Objective(model.objective),
        model.unit,
        model.words,
    )


def _matrix(rows: _Rows, name: str) -> NDArray[np.int64]:
    if len({len(row) for row in rows}) > 1:
        raise Invalid(Message("{name}: its rows do not have the same length", name=name))
    try:
        return np.array(
            [[NEVER if time is None else time for time in row] for row in rows], np.int64
        ).reshape(len(rows), -1 if rows else 0)
    except OverflowError:
        raise Invalid(
            Message("{name}: a number in it is too large: use a larger unit", name=name)
        ) from None


def route_suggestion_text(suggestion: RouteSuggestion) -> str:
    """Return a suggestion as JSON, with all its fields, also the history of the search.

    The route's `charges` are a mapping by position in the route; in JSON these keys are strings.
    """
    return json.dumps(asdict(suggestion), ensure_ascii=False) + "\n"
