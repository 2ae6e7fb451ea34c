"""Missions in which every field of the language takes every kind of value, sensible or not.

Made from the models themselves, so that a new field is among them without being named here.
"""

from enum import Enum
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

import annotated_types
from hypothesis import strategies as st

from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_compiler.il.velocities import of_ways_on, of_ways_there

INTEGERS = st.integers(-(2**63), 2**63 - 1)
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)


def carried_missions() -> st.SearchStrategy[Mission]:
    """Those that ROS messages say in whole: what was left out is not in them, and velocities are
    those of the way on."""
    return missions().map(_carried)


def _carried(mission: Mission) -> Mission:
    mission, differ = of_ways_there(mission.model_copy(update={"left_out": ()}))
    if not differ and of_ways_there(of_ways_on(mission)[0]) == (mission, ()):
        return mission
    tasks = tuple(task.model_copy(update={"velocity": None}) for task in mission.tasks)
    return mission.model_copy(update={"tasks": tasks})


def missions() -> st.SearchStrategy[Mission]:
    """Missions of the right shape; few of them make sense. Integers have up to 64 bits."""
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
    return plain.map(_mended(limits)).filter(lambda value: _kept(value, limits))


def _mended(limits: tuple[Any, ...]) -> Any:
    """Turns most values into allowed ones, so that few have to be thrown away."""

    def mend(value: Any) -> Any:
        if any(isinstance(limit, annotated_types.MinLen) for limit in limits):
            return value or "x"
        least, most = _least(limits), _most(limits)
        if least is not None and value < least:
            value = -value
        if any(isinstance(limit, annotated_types.Lt) for limit in limits) and value >= most:
            return most / 2
        return value if most is None or value <= most else most

    return mend


def _least(limits: tuple[Any, ...]) -> Any:
    for limit in limits:
        if isinstance(limit, annotated_types.Ge):
            return limit.ge
        if isinstance(limit, annotated_types.Gt):
            return limit.gt
    return None


def _most(limits: tuple[Any, ...]) -> Any:
    for limit in limits:
        if isinstance(limit, annotated_types.Le):
            return limit.le
        if isinstance(limit, annotated_types.Lt):
            return limit.lt
    return None


def _kept(value: Any, limits: tuple[Any, ...]) -> bool:
    least, most = _least(limits), _most(limits)
    if any(isinstance(limit, annotated_types.Gt) and value <= limit.gt for limit in limits):
        return False
    return (least is None or value >= least) and (most is None or value <= most)
