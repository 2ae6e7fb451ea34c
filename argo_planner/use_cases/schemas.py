"""The JSON Schemas of Argo's files."""

from enum import StrEnum

from argo_compiler.schemas import SchemaName, read_schema


class FileKind(StrEnum):
    """The files that have a schema."""

    MISSION = "mission"
    MACHINE = "machine"
    PROGRESS = "progress"
    FAULTS = "faults"


def schema(kind: FileKind) -> str:
    """The JSON Schema of files of that kind."""
    if kind is not FileKind.FAULTS:
        return read_schema(SchemaName(kind))
    from argo_compiler.schemas.generate import schema_of
    from argo_env.faults.kinds import FaultFile

    return schema_of(FaultFile, kind)
