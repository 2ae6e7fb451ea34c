"""Writers of a recorder's topics, to a file or a viewer; and JSON schemas that viewers understand.

Foxglove shows a JSON topic whose schema has objects, arrays of one kind of item, and scalars.
Its open-source version knows no `$ref` and no `anyOf`, which pydantic uses for parts and for fields
that may be None; so parts are put where they are used, and a field that may be None is one that may
be left out.
"""

import json
from abc import abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from argo_compiler.base.model import Model

if TYPE_CHECKING:  # what the extra brings
    from google.protobuf.message import Message


class TopicWriter:
    """Takes messages on topics, at simulated times (s). Holds the channels of the topics; what a
    writer keeps besides them, and when, is its own business."""

    until: float | None = None
    """s up to which all can be read, whatever happens; None: nothing can"""

    def __init__(self) -> None:
        self._channels: dict[str, Any] = {}

    def put(self, topic: str, message: "Message", t: float) -> None:
        """Tells a protobuf message at time t (s)."""
        if topic not in self._channels:
            from mcap_protobuf.schema import build_file_descriptor_set

            schema = build_file_descriptor_set(type(message)).SerializeToString(deterministic=True)
            self._open(topic, "protobuf", message.DESCRIPTOR.full_name, schema)
        self._tell(topic, message.SerializeToString(), t)

    def put_json(self, topic: str, message: Model, t: float) -> None:
        """Tells a model as JSON at time t (s); fields that are None are left out."""
        if topic not in self._channels:
            schema = json.dumps(plain_schema(type(message)), ensure_ascii=False).encode()
            self._open(topic, "json", f"argo.{type(message).__name__}", schema)
        self._tell(topic, message.model_dump_json(exclude_none=True).encode(), t)

    def attach(self, name: str, media_type: str, content: str | bytes, t: float = 0.0) -> None:
        """A file that belongs to the run."""

    def describe(self, name: str, facts: Mapping[str, str]) -> None:
        """Texts by name."""

    def flush_if_due(self, t: float) -> None:
        """Time has passed."""

    def flush(self, t: float) -> None:
        """What came before the time t is to be kept."""

    def close(self) -> None:
        """The run is over."""

    @abstractmethod
    def _open(self, topic: str, encoding: str, name: str, schema: bytes) -> None:
        """Makes the channel of a topic; `encoding` is `protobuf` or `json`."""

    @abstractmethod
    def _tell(self, topic: str, data: bytes, t: float) -> None:
        """Tells a message of a topic whose channel there is."""


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
