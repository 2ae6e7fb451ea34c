"""The fields that a model has at a path, for hints about those that it has not."""

from typing import Any, get_args

from argo_compiler.json_places import JsonPath
from argo_compiler.model import Model
from argo_compiler.names import nearest_name


def field_hint(model: type[Model], path: JsonPath) -> str:
    """What to do about the unknown field at that path of a `model`."""
    owner = _model_at(model, path[:-1])
    near = nearest_name(str(path[-1]), tuple(owner.model_fields)) if owner else None
    return f"is `{near}` meant?" if near else "check its spelling or remove it"


def _model_at(model: type[Model], path: JsonPath) -> type[Model] | None:
    found: type[Model] | None = model
    for step in path:
        if isinstance(step, str) and found:
            ahead: list[Any] = [found.model_fields[step].annotation]
            found = None
            while ahead and found is None:
                part = ahead.pop()
                if isinstance(part, type) and issubclass(part, Model):
                    found = part
                ahead += get_args(part)
    return found
