"""Data of a robot for planning and driving (`urdf/robot/<name>.yaml`); and the speeds that it
reaches in fact, beside those that it is told to go at."""

import math
import os
from enum import StrEnum
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, Field, ValidationError, model_validator

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.files import cache, resources


class MotionKind(StrEnum):
    """The kinds of motions that a path is made of; each has a speed of its own."""

    AHEAD = "ahead"
    """forwards on the flat"""
    REVERSE = "reverse"
    """backwards on the flat"""
    UP = "up"
    """backwards up stairs"""
    DOWN = "down"
    """forwards down stairs"""
    TURN = "turn"
    """in place"""


def drive_kind(gear: int, on_stairs: bool) -> MotionKind:
    """The kind of a drive in gear +1 or -1. On stairs the front is the lower end."""
    if on_stairs:
        return MotionKind.DOWN if gear > 0 else MotionKind.UP
    return MotionKind.AHEAD if gear > 0 else MotionKind.REVERSE


class MotionPace(Model):
    """What one kind of motion takes: its length over the real speed, and a time for each motion."""

    share: float = Field(1.0, gt=0)
    """of the speed that is told, what the robot reaches"""
    lost: float = Field(0.0, ge=0)
    """s that each motion takes in addition, to set off and to come to rest"""


class Calibration(Model):
    """The pace of each kind of motion. Without a measurement a robot does as it is told."""

    ahead: MotionPace = MotionPace()
    reverse: MotionPace = MotionPace()
    up: MotionPace = MotionPace()
    down: MotionPace = MotionPace()
    turn: MotionPace = MotionPace()

    def pace(self, kind: MotionKind) -> MotionPace:
        pace: MotionPace = getattr(self, kind)
        return pace


_Described = TypeVar("_Described", bound=BaseModel)


class Footprint(Model):
    """The rectangle that the robot covers on the ground, about its point of rotation, in m."""

    front: float = Field(gt=0)
    rear: float = Field(gt=0)
    half_width: float = Field(gt=0)

    @property
    def radius(self) -> float:
        """m, of the circle that the robot sweeps when it turns in place."""
        return math.hypot(max(self.front, self.rear), self.half_width)


class SensorSpec(Model):
    """Where the camera is when the arm is raised, and what it can see."""

    offset: tuple[float, float, float]
    """m, from the robot's point on the ground, in its frame"""
    min_range: float = Field(gt=0)
    max_range: float = Field(gt=0)
    """m, from the camera to the face of a checkpoint"""
    max_obliqueness: float = Field(gt=0, lt=90)
    """deg, between the face's normal and the line of sight"""
    measuring_time: float = Field(gt=0)
    """s, to raise the arm, look, and stow the arm, a third each"""

    @property
    def stowing_time(self) -> float:
        """s, to stow the raised arm; to raise it takes as long."""
        return self.measuring_time / 3


class PowerSpec(Model):
    """What the robot draws from its battery, computers and sensors included, in W."""

    driving: float = Field(gt=0)
    """on the flat, forwards or backwards"""
    turning: float = Field(gt=0)
    """in place"""
    climbing: float = Field(gt=0)
    """up stairs"""
    descending: float = Field(gt=0)
    """down stairs"""
    measuring: float = Field(gt=0)
    """standing, the arm in motion or raised"""
    standing: float = Field(gt=0)
    """standing, the arm stowed"""
    charging: float = Field(gt=0)
    """W that the docking station gives beside what the robot draws"""


class RobotSpec(Model):
    """A robot: its model, its measures, the speeds that it aims at and what becomes of them.

    `speed` to `turn_rate` are what a drive is told; `seconds` says how long a motion takes in fact,
    and all plans count with that.
    """

    name: str
    urdf: str
    """file name, beside the description"""
    footprint: Footprint
    track_gauge: float = Field(gt=0)
    """m, between the middles of the tracks"""
    track_length: float = Field(gt=0)
    """m, the part of the tracks that carries, about the point of rotation"""
    driving_height: float = Field(gt=0)
    """m, with the arm stowed"""
    max_step: float = Field(gt=0)
    """m, the highest single step that it climbs"""
    speed: float = Field(gt=0)
    """m/s on the flat"""
    reverse_speed: float = Field(gt=0)
    """m/s backwards on the flat"""
    stair_up_speed: float = Field(gt=0)
    """m/s along the slope"""
    stair_down_speed: float = Field(gt=0)
    """m/s along the slope"""
    turn_rate: float = Field(gt=0)
    """deg/s, turning in place"""
    battery: float = Field(gt=0)
    """Wh that may be used on one charge"""
    power: PowerSpec
    arm_stowed: dict[str, float]
    """deg, joints of the arm while driving"""
    arm_raised: dict[str, float]
    """deg, joints of the arm while measuring"""
    sensor: SensorSpec
    calibration: Calibration = Calibration()
    """from `<name>.calibration.yaml`, where there is one"""

    @model_validator(mode="after")
    def _arm_is_its_models(self) -> "RobotSpec":
        if odd := self.arm_stowed.keys() ^ self.arm_raised.keys():
            raise ValueError(
                f"arm_stowed and arm_raised name the same joints; in only one there are: "
                f"{', '.join(sorted(odd))}"
            )
        if unknown := self.arm_stowed.keys() - _joints(self.urdf):
            raise ValueError(
                f"arm_stowed and arm_raised name joints of {self.urdf}; it has no "
                f"{', '.join(sorted(unknown))}"
            )
        return self

    @property
    def turn_rate_radians(self) -> float:
        """rad/s."""
        return math.radians(self.turn_rate)

    def told_speed(self, kind: MotionKind) -> float:
        """m/s that a drive of this kind aims at; rad/s for a turn."""
        return {
            MotionKind.AHEAD: self.speed,
            MotionKind.REVERSE: self.reverse_speed,
            MotionKind.UP: self.stair_up_speed,
            MotionKind.DOWN: self.stair_down_speed,
            MotionKind.TURN: self.turn_rate_radians,
        }[kind]

    def real_speed(self, kind: MotionKind) -> float:
        """m/s that a drive of this kind reaches; rad/s for a turn."""
        return self.told_speed(kind) * self.calibration.pace(kind).share

    def seconds(self, kind: MotionKind, amount: float, told: float | None = None) -> float:
        """How long a motion over `amount` (m, or rad for a turn) takes, if it is `told` a speed of
        its own (m/s)."""
        pace = self.calibration.pace(kind)
        return amount / ((told or self.told_speed(kind)) * pace.share) + pace.lost


@lru_cache
def _joints(urdf: str) -> frozenset[str]:
    """Return the names of a model's joints; ValueError if there is no such model."""
    from xml.parsers import expat  # alone it is imported faster than ElementTree

    names: set[str] = set()

    def note(tag: str, attributes: dict[str, str]) -> None:
        if tag == "joint":
            names.add(attributes.get("name", ""))

    parser = expat.ParserCreate()
    parser.StartElementHandler = note
    try:
        parser.Parse((robot_folder() / urdf).read_bytes(), True)
    except (OSError, expat.ExpatError) as error:
        raise ValueError(f"the robot's model {urdf} can't be read: {error}") from None
    return frozenset(names)


def checked_robot(robot: RobotSpec) -> RobotSpec:
    """The robot, if its description makes sense, which pydantic's `model_copy` does not look at;
    else Invalid."""
    try:
        return RobotSpec.model_validate(dict(robot))
    except ValidationError as error:
        raise Invalid(f"robot {robot.name}: {error}") from error


def load_robot(name: str = "tracker") -> RobotSpec:
    """The robot of that name; ArgoError if there is none or its description makes no sense."""
    path, calibrated = robot_folder() / f"{name}.yaml", calibration_file(name)
    if not os.path.isfile(path):
        known = sorted(p.stem for p in robot_folder().glob("*.yaml") if "." not in p.stem)
        raise NotFound(f"no robot `{name}`; there are: {', '.join(known)}")
    spec: RobotSpec = _described(RobotSpec, path, path.read_text(encoding="utf-8"))
    if not os.path.isfile(calibrated):
        return spec
    paces = _described(Calibration, calibrated, calibrated.read_text(encoding="utf-8"))
    return spec.model_copy(update={"calibration": paces})


@lru_cache(maxsize=16)  # each time that a site is opened
def _described(kind: type[_Described], path: Path, text: str) -> _Described:
    """Return what the text of a file describes. The fields that it sets are kept on disk."""
    parts = cache.entry_for([text], cache.ROBOTS)
    known = parts.load_text("fields")
    try:
        if known is not None:
            return kind.model_validate_json(known)
        described = kind.model_validate(_read_yaml(path, text))
    except ValidationError as error:
        raise Invalid(f"{path}: {error}") from error
    parts.store_text("fields", described.model_dump_json(exclude_unset=True))
    return described


def _read_yaml(path: Path, text: str) -> Any:
    import yaml  # takes longer to import than to read any robot

    try:
        return yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except yaml.YAMLError as error:
        raise Invalid(f"{path}: {error}") from error


def calibration_file(name: str) -> Path:
    """Where the calibration of the robot of that name lies, if there is one."""
    return robot_folder() / f"{name}.calibration.yaml"


def robot_folder() -> Path:
    """Where the robots' models and descriptions lie."""
    return resources.urdf() / "robot"
