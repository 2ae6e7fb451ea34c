"""The kinematics of the camera's arm: joints for a place and a line of sight, and back.

The arm turns about the vertical, its shoulder, elbow and wrist about the horizontal across it, and
the camera about the upright axis of the head, so that it can look past the plane of the arm: with
the first four joints alone the camera would always look away from the arm's foot, and a face that
is turned sideways could not be seen.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose

JOINTS = ("arm_yaw", "arm_shoulder", "arm_elbow", "arm_wrist", "camera_pan")

_FOOT = np.array([-0.10, 0.0, 0.66])  # m, the shoulder in the robot's frame
_UPPER_ARM, _FOREARM = 0.55, 0.43  # m
_LENS = 0.07  # m from the head's axis to the optical centre
_LIMITS = np.array([3.1415, 1.8, 3.0, 3.0, 2.6])  # rad either way
_NONE = 1e-9  # m


@dataclass(frozen=True)
class CameraPose:
    """Where the camera is (m, in the site's frame) and how it is turned: the columns of `rotation`
    are its axes, to the right, down, and along the line of sight, as OpenCV has them."""

    position: NDArray[np.float64]
    rotation: NDArray[np.float64]


def forward(joints: NDArray[np.float64], pose: BodyPose) -> CameraPose:
    """The camera's pose for joints (rad, in the order of `JOINTS`) of the robot at `pose`."""
    yaw, shoulder, elbow, wrist, pan = joints.tolist()
    reach = _UPPER_ARM * math.sin(shoulder) + _FOREARM * math.sin(shoulder + elbow)
    rise = _UPPER_ARM * math.cos(shoulder) + _FOREARM * math.cos(shoulder + elbow)
    head = _FOOT + np.array([reach * math.cos(yaw), reach * math.sin(yaw), rise])
    turned = _about_z(yaw) @ _about_y(shoulder + elbow + wrist) @ _about_z(pan)
    eye = head + _LENS * turned[:, 0]
    body = _about_z(pose.yaw) @ _about_y(pose.pitch) @ _about_x(pose.roll)
    axes = body @ turned
    optical = np.column_stack([-axes[:, 1], -axes[:, 2], axes[:, 0]])
    return CameraPose(body @ eye + np.array([pose.x, pose.y, pose.z]), optical)


def inverse(
    eye: NDArray[np.float64], target: NDArray[np.float64], pose: BodyPose
) -> Iterator[NDArray[np.float64]]:
    """All ways to bring the lens to `eye` and look at `target` (m), in the order of `JOINTS` (rad).

    Up to eight: the arm's yaw or that plus a half turn, the camera's picture upright or upside
    down, the elbow bent either way. None if that is out of reach.
    """
    body = _about_z(pose.yaw) @ _about_y(pose.pitch) @ _about_x(pose.roll)
    sight = body.T @ (target - eye)
    sight /= np.linalg.norm(sight)
    head = body.T @ (eye - np.array([pose.x, pose.y, pose.z])) - _LENS * sight - _FOOT
    away = math.hypot(head[0], head[1])
    # Right above or below its foot the arm may have any yaw: that of the line of sight.
    toward = math.atan2(head[1], head[0]) if away > _NONE else math.atan2(sight[1], sight[0])
    for yaw, reach in ((toward, away), (_wrapped(toward + math.pi), -away)):
        span = math.hypot(reach, head[2])
        cosine = (span**2 - _UPPER_ARM**2 - _FOREARM**2) / (2 * _UPPER_ARM * _FOREARM)
        if abs(cosine) > 1.0 + 1e-9:
            continue
        cosine = max(-1.0, min(1.0, cosine))
        seen = _about_z(yaw).T @ sight
        pan = math.asin(max(-1.0, min(1.0, float(seen[1]))))
        pitch = math.atan2(-seen[2], seen[0])
        turns = [(pan, pitch), (_wrapped(math.pi - pan), _wrapped(pitch + math.pi))]
        # An upright picture first.
        turns.sort(key=lambda turn: abs(turn[1]))
        for pan, pitch in turns:
            for elbow in (math.acos(cosine), -math.acos(cosine)):
                shoulder = math.atan2(reach, head[2]) - math.atan2(
                    _FOREARM * math.sin(elbow), _UPPER_ARM + _FOREARM * math.cos(elbow)
                )
                wrist = _wrapped(pitch - shoulder - elbow)
                joints = np.array([yaw, _wrapped(shoulder), elbow, wrist, pan])
                if (np.abs(joints) <= _LIMITS).all():
                    yield joints


def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi


def _about_z(angle: float) -> NDArray[np.float64]:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _about_y(angle: float) -> NDArray[np.float64]:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def _about_x(angle: float) -> NDArray[np.float64]:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
