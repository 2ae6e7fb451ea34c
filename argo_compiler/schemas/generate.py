"""Makes the JSON Schemas from the models, with the docstrings of fields as descriptions."""

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
    """Without titles of fields, which would only repeat their names."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002
        return False


def schema_text(name: SchemaName) -> str:
    """The schema of that name as it is shipped."""
    return schema_of(MODELS[name], name)


def schema_of(model: type[Model], name: str) -> str:
    """The schema of the files that hold such a model; `name` says what they are."""
    schema = model.model_json_schema(schema_generator=_Generator)
    described = {m.__name__: m for m in _models(model)}
    for title, definition in [(model.__name__, schema), *schema.get("$defs", {}).items()]:
        if title in described:
            _describe(definition, described[title])
    head = {"$schema": GenerateJsonSchema.schema_dialect, "title": f"Argo {name}"}
    return json.dumps(head | schema | head, indent=2, ensure_ascii=False) + "\n"


def _models(model: type[Model]) -> set[type[Model]]:
    """The model and all models that its fields are made of."""
    found: set[type[Model]] = set()
    ahead: list[Any] = [model]
    while ahead:
        part = ahead.pop()
        if isinstance(part, type) and issubclass(part, Model) and part not in found:
            found.add(part)
            ahead += [field.annotation for field in part.model_fields.values()]
        ahead += getattr(part, "__args__", ())
    return found


def _describe(definition: dict[str, Any], model: type[Model]) -> None:
    # A field that is inherited is described where it is said first.
    for base in (c for c in model.__mro__ if issubclass(c, Model)):
        for name, text in field_docstrings(base).items():
            if name in definition.get("properties", {}):
                definition["properties"][name].setdefault("description", text)


def field_docstrings(model: type[Model]) -> dict[str, str]:
    """The text below each field of a model's class."""
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
