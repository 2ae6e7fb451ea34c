"""The file of an evaluation: what is run, how often, and what must hold."""

from pydantic import Field, field_validator, model_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model
from argo_compiler.files.loading import decode_text, require_size
from argo_env.evaluation.case import AS_WRITTEN, NO_FAULTS
from argo_env.evaluation.plan import parse_seeds
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.files.yaml_file import parse_yaml
from argo_env.run.drives_and_sensors import DRIVES, IDEAL, SENSORS

MAX_BYTES = 1_000_000
"""of an evaluation's file; one takes some hundred bytes"""


class MissionEntry(Model):
    """A mission of an evaluation."""

    file: str
    """path of its script or JSON, from the folder of the evaluation's file"""
    name: str | None = None
    """what it is called in tables; None: the file's name"""
    start_area: int | None = None
    """where the script leaves it"""
    end_area: int | None = None
    """where the script leaves it"""


class StopEntry(Model):
    """When there are enough runs, before all seeds are used."""

    width: float | None = Field(default=None, gt=0, lt=1)
    """of the interval of each plan's rate of success"""
    every: int = Field(default=20, ge=1)
    """seeds after which one looks"""


class DrawnFaults(Model):
    """Faults that come with a probability."""

    file: str
    """path of their distribution, from the folder of the evaluation's file"""
    strata: bool = False
    """whether each is run often enough by itself, and the whole put together by probability"""


class EvaluationFile(Model):
    """What an evaluation is made of: each mission with each site, robot, drive, sensor, policy and
    faults, in the world of each seed."""

    name: str = Field(default="evaluation", min_length=1, max_length=100)
    missions: tuple[str | MissionEntry, ...] = Field(min_length=1)
    sites: tuple[str, ...] = Field(default=("umad",), min_length=1)
    robots: tuple[str, ...] = Field(default=("tracker",), min_length=1)
    drives: tuple[str, ...] = Field(default=("route",), min_length=1)
    sensors: tuple[str, ...] = Field(default=(IDEAL,), min_length=1)
    policies: tuple[str, ...] = Field(default=(AS_WRITTEN,), min_length=1)
    """in which order tasks are done: `as written`, `optimised`, or `module:function`"""
    faults: tuple[str, ...] | DrawnFaults = (NO_FAULTS,)
    """files or folders of faults, and `none`; or a distribution that they are drawn from"""
    seeds: str | int | tuple[int, ...] = "0..99"
    worlds: Variation = NO_VARIATION
    """what differs from world to world"""
    require: tuple[str, ...] = ()
    """what must hold, such as `success >= 0.98`: one stops when it is decided. One alone needs no
    list"""
    stop: StopEntry = StopEntry()
    control: str | None = None
    """a cheap drive whose runs help to estimate what those of the drive bring, if that pays"""

    @field_validator("drives")
    @classmethod
    def _drives(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        return _known(names, DRIVES, "drive")

    @field_validator("control")
    @classmethod
    def _control(cls, name: str | None) -> str | None:
        return name if name is None else _known((name,), DRIVES, "drive")[0]

    @field_validator("sensors")
    @classmethod
    def _sensors(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        return _known(names, tuple(SENSORS), "sensor")

    @field_validator("seeds", mode="before")
    @classmethod
    def _seeds(cls, said: object) -> str:
        several = said if isinstance(said, list | tuple) else [said]
        text = ",".join(map(str, several))
        try:
            parse_seeds(text)
        except Invalid as error:
            raise ValueError(str(error)) from None
        return text

    @field_validator("require", mode="before")
    @classmethod
    def _one_alone(cls, said: object) -> object:
        return (said,) if isinstance(said, str) else said

    @field_validator("require")
    @classmethod
    def _requirements(cls, said: tuple[str, ...]) -> tuple[str, ...]:
        try:
            for one in said:
                parse_requirement(one)
        except Invalid as error:
            raise ValueError(str(error)) from None
        return said

    @model_validator(mode="after")
    def _no_requirement_on_strata(self) -> "EvaluationFile":
        if self.strata and self.require:
            raise ValueError(
                "strata have no worlds in common, so that no requirement can be looked at again "
                "and again: give `stop: {width: ...}` instead"
            )
        return self

    @property
    def strata(self) -> bool:
        """Whether runs go to the faults by how uncertain they are."""
        return isinstance(self.faults, DrawnFaults) and self.faults.strata


def decode_evaluation(content: bytes, source_name: str) -> EvaluationFile:
    """The evaluation in YAML, which messages call `source_name`.

    Raises ArgoError if it is no text, DiagnosticError, with the places, if it is no evaluation.
    """
    require_size(content, source_name, "evaluation", MAX_BYTES)
    text = decode_text(content, source_name, "evaluation")
    return parse_yaml(
        text,
        source_name,
        EvaluationFile,
        "evaluations",
        not_yaml="evaluation.not-yaml",
        duplicate_key="evaluation.duplicate-key",
        wrong_field="evaluation.wrong-field",
    )


def _known(names: tuple[str, ...], known: tuple[str, ...], what: str) -> tuple[str, ...]:
    for name in names:
        if name not in known:
            raise ValueError(f"no {what} `{name}`; there are: {', '.join(known)}")
    return names
