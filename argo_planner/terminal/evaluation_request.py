"""The evaluation that the command line of `argo evaluate` describes: a file, or missions."""

import os
from collections.abc import Mapping
from pathlib import Path

import typer
from pydantic import ValidationError

from argo_compiler.base.errors import Invalid
from argo_compiler.files.loading import read_bytes
from argo_env.evaluation.case import AS_WRITTEN, NO_FAULTS
from argo_env.evaluation.file import MAX_BYTES, EvaluationFile, MissionEntry, decode_evaluation
from argo_env.files.yaml_messages import error_message
from argo_planner.terminal.options import given_options, option_name

_YAML = (".yaml", ".yml")
_OF_COMPARISON = ("compare", "plans", "out", "report", "force")
_OF_FILE = (
    "seeds", "site", "drive", "sensor", "faults", "policy", "require", "width", "control",
    "start_area", "end_area",
)  # fmt: skip
"""options that an evaluation file replaces"""
_OPTIONS = {
    "sites": "--site", "drives": "--drive", "sensors": "--sensor", "policies": "--policy",
    "stop": "--width",
}  # fmt: skip
"""options by field of an evaluation file, for fields with another name"""


def require_comparison_only(context: typer.Context, sources: list[Path] | None) -> None:
    """Raise Invalid for missions and options that `--compare` does not use."""
    if sources and (len(sources) > 1 or os.path.isfile(sources[0])):
        raise Invalid(
            "--compare compares the evaluations in one or two folders and runs nothing: leave the "
            "missions out"
        )
    for option in given_options(context):
        if option not in _OF_COMPARISON:
            raise Invalid(f"--compare runs nothing: leave {option_name(option)} out")


def read_evaluation_request(
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
    trust: bool,
) -> tuple[EvaluationFile, Path, bytes]:
    """Return the evaluation, the folder its paths are relative to, and the content of its file.

    `sources` are one evaluation file, or missions. For missions, the other arguments describe the
    evaluation, the folder is the current one, and the content is empty. With `trust`, the file may
    name code, and files outside of its folder.

    Raises:
        Invalid: There are no sources, an evaluation file is combined with other sources or with
            options that belong in it, or an option has a wrong value.
        ArgoError: The file can't be read, or is no valid evaluation.
    """
    if not sources:
        raise Invalid("name an evaluation file or missions; see `argo evaluate --help`")
    described = [source for source in sources if source.suffix in _YAML]
    if described:
        path = described[0]
        if len(sources) > 1:
            raise Invalid(
                f"{path} is an evaluation file, which names its missions itself: leave the other "
                "arguments out"
            )
        for option in given_options(context):
            if option in _OF_FILE:
                raise Invalid(
                    f"{path} is an evaluation file: write {option_name(option)} into the file "
                    "instead of the command line"
                )
        content = read_bytes(path, "evaluation", MAX_BYTES)
        file = decode_evaluation(content, str(path), trust, path.parent)
        return file, path.parent, content
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
        option = _OPTIONS.get(field, option_name(field))
        raise Invalid(f"{option}: {error_message(fault, fault['loc'])}") from None
