"""JSON Schemas of the files that Argo writes; generated from the models and shipped with Argo.

`python -m argo_compiler.schemas` generates them again after a change of a model.
"""

from enum import StrEnum
from pathlib import Path


class SchemaName(StrEnum):
    """Names of the schemas, by the content of the files that they describe."""

    MISSION = "mission"
    MACHINE = "machine"
    PROGRESS = "progress"


def schema_path(name: SchemaName) -> Path:
    """Return the path of the shipped JSON Schema with this name."""
    return Path(__file__).parent / f"{name}.schema.json"


def read_schema(name: SchemaName) -> str:
    """Return the text of the shipped JSON Schema with this name."""
    return schema_path(name).read_text(encoding="utf-8")
