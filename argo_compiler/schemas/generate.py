"""Generation of the JSON Schemas from the models, with docstrings of fields as descriptions."""

import ast
import inspect
import json
import textwrap
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from argo_compiler.base.model import Model
from argo_compiler.hfsm import Hfsm, Progress
from argo_compiler.il import Mission
from argo_compiler.schemas import SchemaName

MODELS: dict[SchemaName, type[Model]] = {
    SchemaName.MISSION: Mission,
    SchemaName.MACHINE: Hfsm,
    SchemaName.PROGRESS: Progress,
}


class _Generator(GenerateJsonSchema):
    """Generator that omits the titles of fields, which would only repeat their names."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002
        return False


def schema_text(name: SchemaName) -> str:
    """Return the JSON Schema that is to be shipped under a name, as text."""
    return model_schema(MODELS[name], name)


def model_schema(model: type[Model], name: str) -> str:
    """Return the JSON Schema for files of a model, as text; its title has the `name`."""
    schema = model.model_json_schema(schema_generator=_Generator)
    models = {m.__name__: m for m in _nested_models(model)}
    for title, definition in [(model.__name__, schema), *schema.get("$defs", {}).items()]:
        if title in models:
            _describe(definition, models[title])
    header = {"$schema": GenerateJsonSchema.schema_dialect, "title": f"Argo {name}"}
    return json.dumps(header | schema | header, indent=2, ensure_ascii=False) + "\n"


def _nested_models(model: type[Model]) -> set[type[Model]]:
    """Return the model and all models in the types of its fields, at any depth."""
    models: set[type[Model]] = set()
    pending: list[Any] = [model]
    while pending:
        part = pending.pop()
        if isinstance(part, type) and issubclass(part, Model) and part not in models:
            models.add(part)
            pending += [field.annotation for field in part.model_fields.values()]
        pending += getattr(part, "__args__", ())
    return models


def _describe(definition: dict[str, Any], model: type[Model]) -> None:
    # An inherited field gets its description from the most derived class that has one.
    for base in (c for c in model.__mro__ if issubclass(c, Model)):
        for name, text in field_docstrings(base).items():
            if name in definition.get("properties", {}):
                definition["properties"][name].setdefault("description", text)


def field_docstrings(model: type[Model]) -> dict[str, str]:
    """Return the docstring below each field of a model's class, by the field's name."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    if not isinstance(tree, ast.ClassDef):
        return {}
    texts = {}
    for field, below in zip(tree.body, tree.body[1:], strict=False):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(below, ast.Expr)
            and isinstance(below.value, ast.Constant)
            and isinstance(below.value.value, str)
        ):
            texts[field.target.id] = inspect.cleandoc(below.value.value)
    return texts
