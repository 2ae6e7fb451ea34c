"""Base class of writers of topics, to a file or a viewer, and JSON schemas that viewers support.

Foxglove shows a JSON topic whose schema has objects, arrays of one kind of item, and scalars. Its
open-source version does not support `$ref` and `anyOf`, which pydantic uses for nested models and
for fields that may be None. So nested schemas are inlined, and a field that may be None is one that
may be left out.
"""

import json
from abc import abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from argo_compiler.base.model import Model

if TYPE_CHECKING:  # a package of the extra
    from google.protobuf.message import Message


class TopicWriter:
    """Base class of a writer of messages on topics, at simulated times (s).

    It holds the channels of the topics. Subclasses decide what they store besides, and when.
    """

    readable_until: float | None = None
    """time in s up to which all messages stay readable if the process dies; None: none does"""

    def __init__(self) -> None:
        self._channels: dict[str, Any] = {}

    def put(self, topic: str, message: "Message", t: float) -> None:
        """Write a protobuf message at the time t (s)."""
        if topic not in self._channels:
            from mcap_protobuf.schema import build_file_descriptor_set

            schema = build_file_descriptor_set(type(message)).SerializeToString(deterministic=True)
            self._open_channel(topic, "protobuf", message.DESCRIPTOR.full_name, schema)
        self._write_message(topic, message.SerializeToString(), t)

    def put_json(self, topic: str, message: Model, t: float) -> None:
        """Write a model as JSON at the time t (s).

        Left out are fields that are None, and wordings of texts: a recording is in English.
        """
        if topic not in self._channels:
            schema = json.dumps(plain_schema(type(message)), ensure_ascii=False).encode()
            self._open_channel(topic, "json", f"argo.{type(message).__name__}", schema)
        wordings = {name for name in type(message).model_fields if name.endswith(_WORDING)}
        content = message.model_dump_json(exclude_none=True, exclude=wordings)
        self._write_message(topic, content.encode(), t)

    def attach(self, name: str, media_type: str, content: str | bytes, t: float = 0.0) -> None:
        """Store a file of the run, at the time t (s); without an override, nothing is stored."""

    def write_metadata(self, name: str, facts: Mapping[str, str]) -> None:
        """Store metadata under this name: texts by key; without an override, nothing is stored."""

    def flush_if_due(self, t: float) -> None:
        """Store all messages if a period is over at time t (s); do nothing without an override."""

    def flush(self, t: float) -> None:
        """Store all messages; t (s) is the present time. Without an override, do nothing."""

    def complete_without_closing(self) -> None:
        """Write what is pending and completes the recording; do nothing without an override."""

    @abstractmethod
    def _open_channel(self, topic: str, encoding: str, name: str, schema: bytes) -> None:
        """Make the channel of a topic; `encoding` is `protobuf` or `json`."""

    @abstractmethod
    def _write_message(self, topic: str, data: bytes, t: float) -> None:
        """Write a message on a topic that has a channel."""


Schema = dict[str, Any]
_WORDING = "_wording"


def plain_schema(model: type[Model]) -> Schema:
    """Return the JSON schema of a model as viewers support it: without references and null values.

    Nested models are inlined. Fields without such a schema, such as mappings and fields of several
    types, and wordings of texts are left out.
    """
    full = model.model_json_schema(mode="serialization")
    return _plain_object(full, full.get("$defs", {})) | {"title": full["title"]}


def _plain_object(schema: Schema, definitions: Schema) -> Schema:
    plain = {
        name: _plain_field(field, definitions)
        for name, field in schema.get("properties", {}).items()
        if not name.endswith(_WORDING)
    }
    return {"type": "object", "properties": {k: v for k, v in plain.items() if v is not None}}


def _plain_field(schema: Schema, definitions: Schema) -> Schema | None:
    """Return the schema of a field as viewers support it; None if they support none."""
    while "$ref" in schema:
        schema = definitions[schema["$ref"].rpartition("/")[2]]
    if "anyOf" in schema:
        kinds = [kind for kind in schema["anyOf"] if kind.get("type") != "null"]
        return _plain_field(kinds[0], definitions) if len(kinds) == 1 else None
    match schema.get("type"):
        case "object" if "properties" in schema:
            return _plain_object(schema, definitions)
        case "array":
            # The items of a tuple of fixed length are of one kind here, such as coordinates.
            items = _plain_field(
                schema.get("items") or schema.get("prefixItems", [{}])[0], definitions
            )
            return None if items is None else {"type": "array", "items": items}
        case "boolean" | "integer" | "number" | "string" as scalar:
            return {"type": scalar}
    return None
