"""What the ways from a robot to all docks and checkpoints of a site take, estimated."""

import math
import weakref
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_env.navigation import Navigator
from argo_env.robot.pose import BodyPose

_NEAR = 1.0  # m from a dock or view within which the robot is taken to be there


class TravelTimes:
    """What the ways between docks and checkpoints of a site take. Holds what it has worked out."""

    def __init__(self, navigator: Navigator) -> None:
        self._navigator = weakref.ref(navigator)
        site = navigator.site
        docks = [site.docks[number] for number in sorted(site.docks)]
        self._places = [*docks, *(_view(navigator, c.id) for c in site.checkpoints)]
        self._known = known = [k for k, place in enumerate(self._places) if place is not None]
        places = [place for place in self._places if place is not None]
        self._times = np.full((len(self._places), len(self._places)), np.inf)
        self._times[np.ix_(known, known)] = navigator.travel_times(places)
        self._from_everywhere = navigator.parts.made(
            "travel-times", lambda: {"times": navigator.travel_times_to(places)}
        )["times"]

    def row(self, pose: BodyPose, navigator: Navigator) -> NDArray[np.float64]:
        """Estimated s from a pose to the docks and then to the checkpoints, in the order of their
        numbers, infinite where there is no way: as the site is known to `navigator`."""
        if navigator is self._navigator():
            apart = [
                np.inf
                if place is None
                else math.dist((place.x, place.y, place.z), (pose.x, pose.y, pose.z))
                for place in self._places
            ]
            nearest = int(np.argmin(apart))
            if apart[nearest] <= _NEAR:
                return np.asarray(self._times[nearest])
        here = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
        row = np.full(len(self._places), np.inf)
        try:
            state = navigator.state_at(here)
        except Unreachable:
            return row
        if navigator is self._navigator():
            row[self._known] = self._from_everywhere[:, state]
            return row
        known = [k for k, place in enumerate(self._places) if place and _free(navigator, place)]
        places = [place for k in known if (place := self._places[k])]
        row[known] = navigator.travel_times_from(here, places)
        return row


def _view(navigator: Navigator, checkpoint: int) -> Pose | None:
    try:
        return navigator.viewing_pose(checkpoint)
    except Unreachable:
        return None


def _free(navigator: Navigator, pose: Pose) -> bool:
    try:
        navigator.state_at(pose)
    except Unreachable:
        return False
    return True


_found: WeakKeyDictionary[Navigator, TravelTimes] = WeakKeyDictionary()


def travel_times(navigator: Navigator) -> TravelTimes:
    """The travel times of a navigator's site, found once and kept as long as the navigator."""
    if navigator not in _found:
        _found[navigator] = TravelTimes(navigator)
    return _found[navigator]
