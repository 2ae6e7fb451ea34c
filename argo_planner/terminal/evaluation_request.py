"""What the command line asks `argo evaluate` for: a file, or missions with options."""

from collections.abc import Mapping
from pathlib import Path

import typer
from pydantic import ValidationError

from argo_compiler.base.errors import Invalid
from argo_compiler.files.loading import read_bytes
from argo_env.evaluation.case import AS_WRITTEN, NO_FAULTS
from argo_env.evaluation.file import MAX_BYTES, EvaluationFile, MissionEntry, decode_evaluation
from argo_env.files.yaml_messages import error_message
from argo_planner.terminal.options import dashed, given_options

_YAML = (".yaml", ".yml")
_OF_COMPARISON = ("compare", "plans", "out", "report", "force")
_OF_FILE = (
    "seeds", "site", "drive", "sensor", "faults", "policy", "require", "width", "control",
    "start_area", "end_area",
)  # fmt: skip
"""options that say what is evaluated, as an evaluation's file does"""
_OPTIONS = {
    "sites": "--site", "drives": "--drive", "sensors": "--sensor", "policies": "--policy",
    "stop": "--width",
}  # fmt: skip
"""by fields of an evaluation's file, where they have another name"""


def refuse_others(context: typer.Context, sources: list[Path] | None) -> None:
    """Raises Invalid for what a comparison has no use for."""
    if sources:
        raise Invalid("--compare is about evaluations that are there: give no missions")
    for option in given_options(context):
        if option not in _OF_COMPARISON:
            raise Invalid(f"--compare runs nothing, and has no use for {dashed(option)}")


def asked_for(
    context: typer.Context,
    sources: list[Path],
    seeds: str,
    site: str,
    drive: str,
    sensor: str,
    faults: list[str] | None,
    policies: list[str] | None,
    require: list[str] | None,
    width: float | None,
    control: str | None,
    start_area: int | None,
    end_area: int | None,
) -> tuple[EvaluationFile, Path, bytes]:
    """What is to be evaluated, the folder that its paths begin in, and the text of its file."""
    if not sources:
        raise Invalid("give an evaluation's file, or missions; see `argo evaluate --help`")
    described = [source for source in sources if source.suffix in _YAML]
    if described:
        path = described[0]
        if len(sources) > 1:
            raise Invalid(f"{path}: an evaluation's file stands alone: give nothing else")
        for option in given_options(context):
            if option in _OF_FILE:
                raise Invalid(
                    f"{path}: says what is evaluated, and {dashed(option)} would say it again: "
                    "write it into the file"
                )
        content = read_bytes(path, "evaluation", MAX_BYTES)
        return decode_evaluation(content, str(path)), path.parent, content
    missions = tuple(
        MissionEntry(file=str(source), start_area=start_area, end_area=end_area)
        for source in sources
    )
    data = {
        "name": " and ".join(source.stem for source in sources),
        "missions": missions,
        "sites": (site,),
        "drives": (drive,),
        "sensors": (sensor,),
        "policies": tuple(policies or (AS_WRITTEN,)),
        "faults": tuple(faults or (NO_FAULTS,)),
        "seeds": seeds,
        "require": tuple(require or ()),
        "stop": {"width": width},
        "control": control,
    }
    return _validated(data), Path(), b""


def _validated(data: Mapping[str, object]) -> EvaluationFile:
    try:
        return EvaluationFile.model_validate(data)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        field = str(fault["loc"][0]) if fault["loc"] else ""
        option = _OPTIONS.get(field, dashed(field))
        raise Invalid(f"{option}: {error_message(fault, fault['loc'])}") from None
