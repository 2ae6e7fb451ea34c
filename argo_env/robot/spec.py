"""What planning and driving need to know of a robot: `urdf/robot/<name>.yaml`."""

import math
from pathlib import Path

import yaml
from pydantic import Field, ValidationError

from argo_compiler.errors import ArgoError
from argo_compiler.model import Model
from argo_env import resources


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


class RobotSpec(Model):
    """A robot: its model, its measures and the speeds that a plan counts with."""

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

    @property
    def turn_rate_radians(self) -> float:
        """rad/s."""
        return math.radians(self.turn_rate)


def load_robot(name: str = "tracker") -> RobotSpec:
    """The robot of that name; ArgoError if there is none or its description makes no sense."""
    path = robot_folder() / f"{name}.yaml"
    if not path.is_file():
        known = ", ".join(sorted(p.stem for p in robot_folder().glob("*.yaml")))
        raise ArgoError(f"no robot `{name}`; there are: {known}")
    try:
        return RobotSpec.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
    except (yaml.YAMLError, ValidationError) as error:
        raise ArgoError(f"{path}: {error}") from error


def robot_folder() -> Path:
    """Where the robots' models and descriptions lie."""
    return resources.urdf() / "robot"
