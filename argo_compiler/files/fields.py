"""Hints for fields that a model does not have, from the fields that it has at the same path."""

from typing import Any, get_args

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.files.json_places import JsonPath


def unknown_field_hint(model: type[Model], path: JsonPath) -> str:
    """Return a hint for a field that `model` does not have: a similar name, or to check it.

    The path leads to the field in the JSON data of the model.
    """
    names = [name for owner in _models_at(model, path[:-1]) for name in owner.model_fields]
    nearest = nearest_name(str(path[-1]), tuple(dict.fromkeys(names)))
    return (
        Message("is `{nearest}` meant?", nearest=nearest)
        if nearest
        else Message("check its spelling or remove it")
    )


def _models_at(model: type[Model], path: JsonPath) -> list[type[Model]]:
    """Return the models that the value at a path may have.

    There are several if the type is a union. A step of the path may be the `kind` of one of them,
    as in the paths of pydantic's errors, and then chooses that one.
    """
    models = [model]
    for step in path:
        if isinstance(step, int):
            continue
        chosen = [m for m in models if "kind" in m.model_fields and _kind(m) == step]
        owners = [m for m in models if step in m.model_fields]
        if owners:
            models = [
                inner for m in owners for inner in _models_in(m.model_fields[step].annotation)
            ]
        elif chosen:
            models = chosen
    return models


def _kind(model: type[Model]) -> Any:
    return model.model_fields["kind"].default


def _models_in(annotation: Any) -> list[type[Model]]:
    """Return the models in a type annotation, such as those of a list's items."""
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models_in(part)]
