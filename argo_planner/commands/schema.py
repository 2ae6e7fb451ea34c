"""`argo schema`: the JSON Schemas of Argo's files."""

from typing import Annotated

import typer

from argo_compiler.schemas import SchemaName, read_schema


def show_schema(
    name: Annotated[SchemaName, typer.Argument(help="of which file")] = SchemaName.MISSION,
) -> None:
    """Print the JSON Schema of a mission, a machine or a mission's progress."""
    print(read_schema(name), end="")
