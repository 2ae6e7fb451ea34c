"""Standstill of a robot, as on a blocked path, and the time until it gives the path up.

The tracked drive notices sooner that it is stuck, and tries to get free: see `tracked/drive.py`. At
an obstacle that the robot sees, it does not wait, but takes another path or fails: see
`argo_env/run/action.py`.
"""

import math

import numpy as np

from argo_env.robot.pose import PoseArray, PoseTuple, pose_tuple_at

PATIENCE = 30.0  # s without any motion, after which the robot gives its path up
_MOVED = 1e-3  # m or rad, above which a change of pose is a motion


def first_motionless_step_from_1(before: PoseTuple, poses: PoseArray) -> int:
    """Return the number, from 1, of the first step without noticeable motion.

    Step k leads to pose k of `poses`, from the pose before that one; the first step leads from
    `before`. If the robot moves noticeably in each of n steps, the result is n + 1.
    """
    all_poses = np.concatenate([[before], poses])
    change = np.abs(np.diff(all_poses, axis=0))
    surely = (change[:, :4] > _MOVED).any(axis=1)
    for k in np.flatnonzero(~surely).tolist():
        if not has_moved_noticeably(pose_tuple_at(all_poses, k), pose_tuple_at(all_poses, k + 1)):
            return k + 1
    return len(all_poses)


def has_moved_noticeably(before: PoseTuple, after: PoseTuple) -> bool:
    """Return True if two poses differ by more than 1 mm in position or 1 mrad in heading."""
    return math.dist(before[:3], after[:3]) > _MOVED or abs(after[3] - before[3]) > _MOVED
