"""JSON schemas that viewers understand: without references and alternatives.

Foxglove shows a JSON topic whose schema has objects, arrays of one kind of item, and scalars.
Its open-source version knows no `$ref` and no `anyOf`, which pydantic uses for parts and for fields
that may be None; so parts are put where they are used, and a field that may be None is one that may
be left out.
"""

from typing import Any

from argo_compiler.base.model import Model

Schema = dict[str, Any]


def plain_schema(model: type[Model]) -> Schema:
    """The schema of what a model writes with `exclude_none`; fields of free form, such as
    mappings, are not in it."""
    full = model.model_json_schema(mode="serialization")
    return _object(full, full.get("$defs", {})) | {"title": full["title"]}


def _object(schema: Schema, parts: Schema) -> Schema:
    plain = {name: _plain(field, parts) for name, field in schema.get("properties", {}).items()}
    return {"type": "object", "properties": {k: v for k, v in plain.items() if v is not None}}


def _plain(schema: Schema, parts: Schema) -> Schema | None:
    """A field's schema; None if it can't be said plainly."""
    while "$ref" in schema:
        schema = parts[schema["$ref"].rpartition("/")[2]]
    if "anyOf" in schema:
        kinds = [kind for kind in schema["anyOf"] if kind.get("type") != "null"]
        return _plain(kinds[0], parts) if len(kinds) == 1 else None
    match schema.get("type"):
        case "object" if "properties" in schema:
            return _object(schema, parts)
        case "array":
            # The items of a tuple of fixed length are of one kind here, such as coordinates.
            items = _plain(schema.get("items") or schema.get("prefixItems", [{}])[0], parts)
            return None if items is None else {"type": "array", "items": items}
        case "boolean" | "integer" | "number" | "string" as scalar:
            return {"type": scalar}
    return None
