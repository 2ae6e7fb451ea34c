"""Driving to a pose."""

from .action_state import ActionState
from .robot import robot


class WaypointState(ActionState):
    """Drives to a pose.

    -- task             string    Name of the task.
    -- pose             float[]   x, y, z (m) and yaw (rad).
    -- way              dict      How it goes there, as `Robot.drive` is told.
    -- retries          int       How often a failed action is tried again.
    -- time_limit       float     s for each attempt; 0.0: no limit.
    -- depth            int       How many groups are around.

    #> memory           dict      What the mission knows.

    <= done                       Arrived.
    <= failed                     Not arrived, all retries included.
    <= time_up                    The time of a group around is up.
    """

    def __init__(self, task, pose, way, retries, time_limit, depth):
        super().__init__(task, way, retries, time_limit, depth)
        self._pose = pose

    def _begin(self):
        robot().drive(self._task, self._pose, **self._way)
