"""Evaluation files in YAML: what is run, how often, and which requirements must be met."""

from pathlib import Path

from pydantic import Field, field_validator, model_validator

from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.files.loading import decode_text, require_size
from argo_env.evaluation.case import AS_WRITTEN, NO_FAULTS
from argo_env.evaluation.plan import NO_REQUIREMENT_ON_STRATA, parse_seeds
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.files.folders import leaves_folder, links_leave_folder
from argo_env.files.yaml_file import parse_yaml
from argo_env.run.drives_and_sensors import IDEAL, SENSORS, drive_names

MAX_BYTES = 1_000_000
"""largest size of an evaluation file; a usual one has some hundred bytes"""


class MissionEntry(Model):
    """Mission in an evaluation file."""

    file: str
    """path of its script or JSON, relative to the folder of the evaluation file"""
    name: str | None = None
    """name in tables; None: the file's name"""
    start_area: int | None = None
    """start area, if the script leaves it open"""
    end_area: int | None = None
    """end area, if the script leaves it open"""


class StopEntry(Model):
    """Rule to stop an evaluation before all seeds are used."""

    width: float | None = Field(default=None, gt=0, lt=1)
    """width that the interval of each plan's success rate must reach"""
    every: int = Field(default=20, ge=1)
    """number of seeds between two checks of the rule"""


class DrawnFaults(Model):
    """Faults that are drawn from a distribution."""

    file: str
    """path of the distribution, relative to the folder of the evaluation file"""
    strata: bool = False
    """whether to sample each fault separately and weight the rates by probability (stratified
    sampling)"""


class EvaluationFile(Model):
    """Content of an evaluation file.

    Each mission is run with each site, robot, drive, sensor, policy and set of faults, in the world
    of each seed.
    """

    name: str = Field(default="evaluation", min_length=1, max_length=100)
    missions: tuple[str | MissionEntry, ...] = Field(min_length=1)
    sites: tuple[str, ...] = Field(default=("umad",), min_length=1)
    robots: tuple[str, ...] = Field(default=("tracker",), min_length=1)
    drives: tuple[str, ...] = Field(default=("route",), min_length=1)
    sensors: tuple[str, ...] = Field(default=(IDEAL,), min_length=1)
    policies: tuple[str, ...] = Field(default=(AS_WRITTEN,), min_length=1)
    """orders of the tasks: `as written`, `optimised`, the name of an installed package's policy, or
    `module:function`"""
    faults: tuple[str, ...] | DrawnFaults = (NO_FAULTS,)
    """files or folders of faults, and `none`; or a distribution to draw faults from"""
    seeds: str | int | tuple[int, ...] = "0..99"
    worlds: Variation = NO_VARIATION
    """values that vary from world to world"""
    require: tuple[str, ...] = ()
    """requirements such as `success >= 0.98`; the evaluation stops when they are decided. A single
    one needs no list"""
    stop: StopEntry = StopEntry()
    control: str | None = None
    """cheap drive whose runs serve as a control variate for those of the drive, if that pays"""

    @field_validator("drives")
    @classmethod
    def _check_drives(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        return _require_known(names, drive_names(), "drive")

    @field_validator("control")
    @classmethod
    def _check_control(cls, name: str | None) -> str | None:
        return name if name is None else _require_known((name,), drive_names(), "drive")[0]

    @field_validator("sensors")
    @classmethod
    def _check_sensors(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        return _require_known(names, tuple(SENSORS), "sensor")

    @field_validator("seeds", mode="before")
    @classmethod
    def _seeds_as_text(cls, value: object) -> str:
        parts = value if isinstance(value, list | tuple) else [value]
        text = ",".join(map(str, parts))
        try:
            parse_seeds(text)
        except Invalid as error:
            raise ValueError(str(error)) from None
        return text

    @field_validator("require", mode="before")
    @classmethod
    def _single_requirement(cls, value: object) -> object:
        return (value,) if isinstance(value, str) else value

    @field_validator("require")
    @classmethod
    def _check_requirements(cls, texts: tuple[str, ...]) -> tuple[str, ...]:
        try:
            for text in texts:
                parse_requirement(text)
        except Invalid as error:
            raise ValueError(str(error)) from None
        return texts

    @model_validator(mode="after")
    def _no_requirement_on_strata(self) -> "EvaluationFile":
        if self.is_stratified and self.require:
            raise ValueError(NO_REQUIREMENT_ON_STRATA)
        return self

    @property
    def is_stratified(self) -> bool:
        """True if runs are allocated to the faults by their uncertainty (stratified sampling)."""
        return isinstance(self.faults, DrawnFaults) and self.faults.strata


def decode_evaluation(
    content: bytes, source_name: str, trusted: bool = False, folder: Path | None = None
) -> EvaluationFile:
    """Parse an evaluation in YAML; messages refer to it as `source_name`.

    Unless it is `trusted`, it names no code, and no files outside of its folder, to which no links
    lead either if `folder` is given. Raises ArgoError if the content is no text or too large, or is
    not trusted, and DiagnosticError, with positions in the text, if it is no evaluation.
    """
    require_size(content, source_name, "evaluation", MAX_BYTES)
    text = decode_text(content, source_name, "evaluation")
    file = parse_yaml(
        text,
        source_name,
        EvaluationFile,
        "evaluations",
        not_yaml="evaluation.not-yaml",
        duplicate_key="evaluation.duplicate-key",
        wrong_field="evaluation.wrong-field",
    )
    if not trusted:
        _require_harmless(file, source_name, folder)
    return file


def _require_harmless(file: EvaluationFile, source_name: str, folder: Path | None) -> None:
    """Raise Invalid if an evaluation names code, or files outside of its folder."""
    for policy in file.policies:
        if ":" in policy:
            raise Invalid(
                Message(
                    "{source_name}: the policy `{policy}` is code, which would be run: read "
                    "it, and trust the file only if you trust that code",
                    source_name=source_name,
                    policy=policy,
                ),
                remedies=(Remedy.TRUST,),
            )
    faults = (file.faults.file,) if isinstance(file.faults, DrawnFaults) else file.faults
    missions = [one if isinstance(one, str) else one.file for one in file.missions]
    for name in (*missions, *file.sites, *faults):
        if leaves_folder(name) or (folder is not None and links_leave_folder(folder, name)):
            raise Invalid(
                Message(
                    "{source_name}: `{name}` is outside of the folder of the file: copy it "
                    "into that folder, or trust the file",
                    source_name=source_name,
                    name=name,
                ),
                remedies=(Remedy.TRUST,),
            )


def _require_known(names: tuple[str, ...], known: tuple[str, ...], what: str) -> tuple[str, ...]:
    for name in names:
        if name not in known:
            raise ValueError(f"no {what} `{name}`; there are: {', '.join(known)}")
    return names
