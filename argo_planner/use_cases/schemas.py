"""The JSON Schemas of Argo's files."""

from enum import StrEnum

from argo_compiler.schemas import SchemaName, read_schema


class FileKind(StrEnum):
    """Kind of file that has a schema."""

    MISSION = "mission"
    MACHINE = "machine"
    PROGRESS = "progress"
    FAULTS = "faults"
    EVALUATION = "evaluation"
    READING = "reading"


def schema(kind: FileKind) -> str:
    """Return the JSON Schema of a kind of file."""
    if kind in SchemaName:
        return read_schema(SchemaName(kind))
    from argo_compiler.schemas.generate import model_schema

    if kind is FileKind.READING:
        from argo_compiler.script.write.reading import MissionReading

        return model_schema(MissionReading, kind)
    if kind is FileKind.EVALUATION:
        from argo_env.evaluation.file import EvaluationFile

        return model_schema(EvaluationFile, kind)
    from argo_env.faults.kinds import FaultFile

    return model_schema(FaultFile, kind)
