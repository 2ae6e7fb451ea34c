"""`argo schema`: print the JSON Schemas of Argo's files."""

from typing import Annotated

import typer

from argo_planner.use_cases.schemas import FileKind, schema


def schema_command(
    name: Annotated[FileKind, typer.Argument(help="kind of file")] = FileKind.MISSION,
) -> None:
    """Print the JSON Schema of one kind of file, such as missions or faults."""
    print(schema(name), end="")
