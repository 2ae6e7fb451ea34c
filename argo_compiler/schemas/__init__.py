"""The JSON Schemas of the files that Argo writes, made from its models and shipped beside this.

`python -m argo_compiler.schemas` writes them anew after a model has changed.
"""

from enum import StrEnum
from pathlib import Path


class SchemaName(StrEnum):
    """What there is a schema of."""

    MISSION = "mission"
    MACHINE = "machine"
    PROGRESS = "progress"


def schema_path(name: SchemaName) -> Path:
    """Where the schema of that name is shipped."""
    return Path(__file__).parent / f"{name}.schema.json"


def read_schema(name: SchemaName) -> str:
    """The text of the shipped schema."""
    return schema_path(name).read_text(encoding="utf-8")
