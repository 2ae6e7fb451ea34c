"""Patience of a robot that does not move, as at a blocked way, until it gives its way up.

The tracked drive notices sooner that it is stuck, and tries to get free: see `tracked/drive.py`. At
an obstacle that the robot sees it does not wait, but takes another way or fails: see
`argo_env/run/action.py`.
"""

import math

import numpy as np

from argo_env.robot.pose import Place, Places, place_of

PATIENCE = 30.0  # s without any motion after which a way is given up
_MOVED = 1e-3  # m or rad that count as a motion


def first_still(before: Place, places: Places) -> int:
    """Return the number, from 1, of the first of the places to which the robot has not moved from
    the one before, or one more than there are if it moves to each."""
    all_places = np.concatenate([[before], places])
    change = np.abs(np.diff(all_places, axis=0))
    surely = (change[:, :4] > _MOVED).any(axis=1)
    for k in np.flatnonzero(~surely).tolist():
        if not has_moved(place_of(all_places, k), place_of(all_places, k + 1)):
            return k + 1
    return len(all_places)


def has_moved(before: Place, after: Place) -> bool:
    """Return whether the robot has moved between two places."""
    return math.dist(before[:3], after[:3]) > _MOVED or abs(after[3] - before[3]) > _MOVED
