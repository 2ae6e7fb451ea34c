"""Data of a robot for planning and driving, from `urdf/robot/<name>.yaml`.

The data include target speeds, which a drive aims at, and a calibration, from which the speeds that
the robot really reaches follow.
"""

import math
import os
import re
from enum import StrEnum
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, Field, ValidationError, field_validator, model_validator

from argo_compiler.base.errors import Invalid, NotFound, reason_text
from argo_compiler.base.model import Model
from argo_env.files import cache, resources


class MotionKind(StrEnum):
    """Kind of a motion, as a part of a path; each kind has its own speed."""

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


def motion_kind(gear: int, on_stairs: bool) -> MotionKind:
    """Return the kind of a straight motion, forwards for gear +1 and backwards for gear -1.

    On stairs, the robot's front is always downhill: forwards is down, and backwards is up.
    """
    if on_stairs:
        return MotionKind.DOWN if gear > 0 else MotionKind.UP
    return MotionKind.AHEAD if gear > 0 else MotionKind.REVERSE


class MotionPace(Model):
    """Calibration of one kind of motion: the real speed, and a constant time for each motion."""

    share: float = Field(1.0, gt=0)
    """ratio of the speed that the robot reaches to the target speed"""
    lost: float = Field(0.0, ge=0)
    """s that each motion takes in addition, to accelerate and to come to rest"""


class Calibration(Model):
    """Calibration of each kind of motion; by default, a robot reaches its target speeds exactly."""

    ahead: MotionPace = MotionPace()
    reverse: MotionPace = MotionPace()
    up: MotionPace = MotionPace()
    down: MotionPace = MotionPace()
    turn: MotionPace = MotionPace()

    def pace_for(self, kind: MotionKind) -> MotionPace:
        pace: MotionPace = getattr(self, kind)
        return pace


_Description = TypeVar("_Description", bound=BaseModel)


class Footprint(Model):
    """Rectangle that the robot covers on the ground, around its point of rotation, in m."""

    front: float = Field(gt=0)
    rear: float = Field(gt=0)
    half_width: float = Field(gt=0)

    @property
    def radius(self) -> float:
        """Radius in m of the circle that the robot sweeps when it turns in place."""
        return math.hypot(max(self.front, self.rear), self.half_width)


class SensorSpec(Model):
    """Position of the camera when the arm is raised, and the limits of its view."""

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
        """Time in s to stow the raised arm; to raise the arm takes as long."""
        return self.measuring_time / 3


class PowerSpec(Model):
    """Power in W that the robot draws from its battery, including computers and sensors."""

    driving: float = Field(gt=0)
    """on the flat, forwards or backwards"""
    turning: float = Field(gt=0)
    """in place"""
    climbing: float = Field(gt=0)
    """up stairs"""
    descending: float = Field(gt=0)
    """down stairs"""
    measuring: float = Field(gt=0)
    """at rest, with the arm in motion or raised"""
    standing: float = Field(gt=0)
    """at rest, with the arm stowed"""
    charging: float = Field(gt=0)
    """W that charge the battery at the docking station, beyond the robot's own consumption"""


class RobotSpec(Model):
    """Robot: its model, its dimensions, its target speeds, its battery and its calibration.

    `speed` to `turn_rate` are target speeds, which a drive aims at. `motion_time` returns the time
    that a motion really takes, and all travel times use it.
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
    """from `<name>.calibration.yaml`, if that file exists"""

    @field_validator("urdf")
    @classmethod
    def _check_urdf(cls, name: str) -> str:
        if not re.fullmatch(r"\w[\w.-]*", name):
            raise ValueError(f"{name!r} is not the name of a file beside the description")
        return name

    @model_validator(mode="after")
    def _check_arm_joints(self) -> "RobotSpec":
        if odd := self.arm_stowed.keys() ^ self.arm_raised.keys():
            raise ValueError(
                f"arm_stowed and arm_raised must name the same joints; only one of them has: "
                f"{', '.join(sorted(odd))}"
            )
        if unknown := self.arm_stowed.keys() - _joints(self.urdf):
            raise ValueError(
                f"arm_stowed and arm_raised must name joints of {self.urdf}; it has no "
                f"{', '.join(sorted(unknown))}"
            )
        return self

    @property
    def turn_rate_radians(self) -> float:
        """Target rate in rad/s for a turn in place."""
        return math.radians(self.turn_rate)

    def target_speed(self, kind: MotionKind) -> float:
        """Return the speed in m/s that a motion of this kind aims at; in rad/s for a turn."""
        return {
            MotionKind.AHEAD: self.speed,
            MotionKind.REVERSE: self.reverse_speed,
            MotionKind.UP: self.stair_up_speed,
            MotionKind.DOWN: self.stair_down_speed,
            MotionKind.TURN: self.turn_rate_radians,
        }[kind]

    def real_speed(self, kind: MotionKind) -> float:
        """Return the speed in m/s that a motion of this kind reaches; in rad/s for a turn."""
        return self.target_speed(kind) * self.calibration.pace_for(kind).share

    def motion_time(self, kind: MotionKind, amount: float, target: float | None = None) -> float:
        """Return the time in s of a motion over `amount` (m, or rad for a turn).

        `target` is its target speed (m/s, or rad/s for a turn), of which the robot reaches the
        calibrated share; None is that of its kind. The time lost at each motion is included.
        """
        pace = self.calibration.pace_for(kind)
        return amount / ((target or self.target_speed(kind)) * pace.share) + pace.lost


@lru_cache
def _joints(urdf: str) -> frozenset[str]:
    """Return the names of the joints in a URDF file of the robots' folder.

    Raises ValueError if the file can't be read or is not XML.
    """
    from xml.parsers import expat  # faster to import than ElementTree

    names: set[str] = set()

    def add_joint(tag: str, attributes: dict[str, str]) -> None:
        if tag == "joint":
            names.add(attributes.get("name", ""))

    parser = expat.ParserCreate()
    parser.StartElementHandler = add_joint
    try:
        parser.Parse((robot_folder() / urdf).read_bytes(), True)
    except (OSError, expat.ExpatError) as error:
        raise ValueError(f"the robot's model {urdf} can't be read: {reason_text(error)}") from None
    return frozenset(names)


def revalidated_robot(robot: RobotSpec) -> RobotSpec:
    """Return the robot, validated again: pydantic's `model_copy` does not validate its changes.

    Raises Invalid if the description makes no sense.
    """
    try:
        return RobotSpec.model_validate(dict(robot))
    except ValidationError as error:
        raise Invalid(f"robot {robot.name}: {error}") from error


def load_robot(name: str = "tracker") -> RobotSpec:
    """Return the robot of that name, with its calibration if there is one.

    Raises NotFound if there is no such robot, and Invalid if its description makes no sense.
    """
    path, calibrated = robot_folder() / f"{name}.yaml", calibration_file(name)
    if not re.fullmatch(r"[\w-]+", name) or not os.path.isfile(path):
        known = sorted(p.stem for p in robot_folder().glob("*.yaml") if "." not in p.stem)
        raise NotFound(f"no robot `{name}`; there are: {', '.join(known)}")
    spec: RobotSpec = _parse_description(RobotSpec, path, path.read_text(encoding="utf-8"))
    if not os.path.isfile(calibrated):
        return spec
    calibration = _parse_description(
        Calibration, calibrated, calibrated.read_text(encoding="utf-8")
    )
    return spec.model_copy(update={"calibration": calibration})


@lru_cache(maxsize=16)  # it is called whenever a site is opened
def _parse_description(kind: type[_Description], path: Path, text: str) -> _Description:
    """Return the model in the text of a file, from the cache on disk or read and stored there."""
    parts = cache.entry_for([text], cache.ROBOTS)
    cached = parts.load_text("fields")
    try:
        if cached is not None:
            return kind.model_validate_json(cached)
        from argo_compiler.files.yaml_text import load_yaml  # importing it takes long

        description = kind.model_validate(load_yaml(text, str(path)))
    except ValidationError as error:
        raise Invalid(f"{path}: {error}") from error
    parts.store_text("fields", description.model_dump_json(exclude_unset=True))
    return description


def calibration_file(name: str) -> Path:
    """Return the path of the calibration of the robot of that name; the file may not exist."""
    return robot_folder() / f"{name}.calibration.yaml"


def robot_folder() -> Path:
    """Return the folder of the robots' models and descriptions."""
    return resources.urdf_folder() / "robot"
