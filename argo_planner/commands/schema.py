"""`argo schema`: the JSON Schemas of Argo's files."""

from enum import StrEnum
from typing import Annotated

import typer

from argo_compiler.schemas import SchemaName, read_schema
from argo_compiler.schemas.generate import schema_of
from argo_env.faults.kinds import FaultFile


class FileKind(StrEnum):
    """The files that have a schema."""

    MISSION = "mission"
    MACHINE = "machine"
    PROGRESS = "progress"
    FAULTS = "faults"


def show_schema(
    name: Annotated[FileKind, typer.Argument(help="of which file")] = FileKind.MISSION,
) -> None:
    """Print the JSON Schema of a mission, a machine, a mission's progress or a file of faults."""
    if name is FileKind.FAULTS:
        print(schema_of(FaultFile, name), end="")
    else:
        print(read_schema(SchemaName(name)), end="")
