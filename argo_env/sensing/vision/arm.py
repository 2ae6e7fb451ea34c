"""Kinematics of the camera's arm, forward and inverse.

The arm turns about the vertical. Shoulder, elbow and wrist turn about the horizontal axis across
the arm, and the camera about the upright axis of the head, so that it can look past the plane of
the arm. With the first four joints alone the camera would always look away from the arm's foot, and
a face that is turned sideways could not be seen.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose

JOINTS = ("arm_yaw", "arm_shoulder", "arm_elbow", "arm_wrist", "camera_pan")

_SHOULDER = np.array([-0.10, 0.0, 0.66])  # m, the shoulder in the robot's frame
_UPPER_ARM, _FOREARM = 0.55, 0.43  # m
_LENS = 0.07  # m from the head's axis to the optical centre
_LIMITS = np.array([3.1415, 1.8, 3.0, 3.0, 2.6])  # rad either way
_EPSILON = 1e-9  # m


@dataclass(frozen=True)
class CameraPose:
    """Pose of the camera in the site's frame."""

    position: NDArray[np.float64]
    """m, shape (3,)"""
    rotation: NDArray[np.float64]
    """columns are the camera's axes as in OpenCV: right, down, and along the line of sight"""


def forward_kinematics(joints: NDArray[np.float64], pose: BodyPose) -> CameraPose:
    """Return the camera's pose for positions of the arm's joints, with the robot at `pose`.

    `joints` are in rad, in the order of `JOINTS`.
    """
    yaw, shoulder, elbow, wrist, pan = joints.tolist()
    reach = _UPPER_ARM * math.sin(shoulder) + _FOREARM * math.sin(shoulder + elbow)
    rise = _UPPER_ARM * math.cos(shoulder) + _FOREARM * math.cos(shoulder + elbow)
    head = _SHOULDER + np.array([reach * math.cos(yaw), reach * math.sin(yaw), rise])
    turned = _about_z(yaw) @ _about_y(shoulder + elbow + wrist) @ _about_z(pan)
    eye = head + _LENS * turned[:, 0]
    body = _about_z(pose.yaw) @ _about_y(pose.pitch) @ _about_x(pose.roll)
    axes = body @ turned
    optical = np.column_stack([-axes[:, 1], -axes[:, 2], axes[:, 0]])
    return CameraPose(body @ eye + np.array([pose.x, pose.y, pose.z]), optical)


def inverse_kinematics(
    eye: NDArray[np.float64], target: NDArray[np.float64], pose: BodyPose
) -> Iterator[NDArray[np.float64]]:
    """Yield all joint positions that bring the lens to `eye` and point it at `target`.

    Both are points of the site in m. Joint positions are in rad, in the order of `JOINTS`. There
    are up to eight: the arm's yaw or that plus a half turn, the camera's picture upright or upside
    down, the elbow bent either way. There are none if `eye` is out of reach.
    """
    body = _about_z(pose.yaw) @ _about_y(pose.pitch) @ _about_x(pose.roll)
    sight = body.T @ (target - eye)
    sight /= np.linalg.norm(sight)
    head = body.T @ (eye - np.array([pose.x, pose.y, pose.z])) - _LENS * sight - _SHOULDER
    away = math.hypot(head[0], head[1])
    # Right above or below its shoulder the arm may have any yaw: take that of the line of sight.
    toward = math.atan2(head[1], head[0]) if away > _EPSILON else math.atan2(sight[1], sight[0])
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
