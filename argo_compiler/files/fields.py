"""The fields that a model has at a path, for hints about those that it has not."""

from typing import Any, get_args

from argo_compiler.base.model import Model
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.files.json_places import JsonPath


def field_hint(model: type[Model], path: JsonPath) -> str:
    """What to do about the unknown field at that path of a `model`."""
    names = [name for owner in _models_at(model, path[:-1]) for name in owner.model_fields]
    near = nearest_name(str(path[-1]), tuple(dict.fromkeys(names)))
    return f"is `{near}` meant?" if near else "check its spelling or remove it"


def _models_at(model: type[Model], path: JsonPath) -> list[type[Model]]:
    """The model at a path, or all that a choice is made among; a path names the one chosen by its
    `kind`."""
    found = [model]
    for step in path:
        if isinstance(step, int):
            continue
        chosen = [m for m in found if "kind" in m.model_fields and _kind(m) == step]
        owners = [m for m in found if step in m.model_fields]
        if owners:
            found = [inner for m in owners for inner in _inside(m.model_fields[step].annotation)]
        elif chosen:
            found = chosen
    return found


def _kind(model: type[Model]) -> Any:
    return model.model_fields["kind"].default


def _inside(annotation: Any) -> list[type[Model]]:
    """The models that values of that type are made of."""
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return [annotation]
    return [model for part in get_args(annotation) for model in _inside(part)]
