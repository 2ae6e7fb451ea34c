"""Missions in which every field of the language takes every kind of value, sensible or not.

The strategies are made from the models, so that they include every new field.
"""

import operator
from enum import Enum
from functools import partial, reduce
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

import annotated_types
from hypothesis import strategies as st

from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_compiler.il.velocities import (
    approach_to_departure_velocities,
    departure_to_approach_velocities,
)

INTEGERS = st.integers(-(2**63), 2**63 - 1)
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)


def carried_missions() -> st.SearchStrategy[Mission]:
    """Draw missions that ROS messages represent completely.

    The messages have no tasks that were left out, and their velocities apply to the next drive.
    """
    return missions().map(_carried)


def _carried(mission: Mission) -> Mission:
    mission, differ = departure_to_approach_velocities(mission.model_copy(update={"left_out": ()}))
    if not differ and departure_to_approach_velocities(
        approach_to_departure_velocities(mission)[0]
    ) == (
        mission,
        (),
    ):
        return mission
    tasks = tuple(task.model_copy(update={"velocity": None}) for task in mission.tasks)
    return mission.model_copy(update={"tasks": tasks})


def missions() -> st.SearchStrategy[Mission]:
    """Draw missions of the right structure; few of them make sense. Integers have up to 64 bits."""
    return _models(Mission)


def _models(model: type[Model]) -> st.SearchStrategy[Any]:
    return st.builds(
        model,
        **{
            name: _values(field.annotation, tuple(field.metadata))
            for name, field in model.model_fields.items()
        },
    )


def _values(annotation: Any, limits: tuple[Any, ...]) -> st.SearchStrategy[Any]:
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return st.one_of(*(_values(part, limits) for part in parts))
    if annotation is NoneType:
        return st.none()
    if origin is Literal:
        return st.sampled_from(parts)
    if origin is tuple and parts[-1] is not ...:
        return st.tuples(*(_values(part, ()) for part in parts))
    if origin is tuple:
        return st.lists(_values(parts[0], ()), max_size=2).map(tuple)
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return st.sampled_from(annotation)
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return _models(annotation)
    plain = {bool: st.booleans(), int: INTEGERS, float: FLOATS, str: TEXTS}[annotation]
    return reduce(_limited, limits, plain)


def _limited(values: st.SearchStrategy[Any], limit: Any) -> st.SearchStrategy[Any]:
    """Restrict a strategy to values within the limit; Hypothesis draws no numbers beyond it."""
    match limit:
        case annotated_types.Ge(least):
            return values.filter(partial(operator.le, least))
        case annotated_types.Gt(least):
            return values.filter(partial(operator.lt, least))
        case annotated_types.Le(most):
            return values.filter(partial(operator.ge, most))
        case annotated_types.Lt(most):
            return values.filter(partial(operator.gt, most))
        case annotated_types.MinLen():
            return values.filter(bool)
    return values
