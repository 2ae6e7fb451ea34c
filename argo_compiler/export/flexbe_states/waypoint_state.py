"""State that drives to a pose."""

from .action_state import ActionState
from .robot import robot


class WaypointState(ActionState):
    """State that drives to a pose.

    -- task             string    Name of the task.
    -- pose             float[]   x, y, z (m) and yaw (rad).
    -- way              dict      Arguments `velocity` and `joints` of `Robot.drive`.
    -- retries          int       Number of retries after a failed action.
    -- time_limit       float     Time in s for each attempt; 0.0: no limit.
    -- depth            int       Number of groups that contain the state.

    #> memory           dict      State of the mission, shared by its states.

    <= done                       Arrived.
    <= failed                     Not arrived, all retries included.
    <= time_up                    The time of a containing group is up.
    """

    def __init__(self, task, pose, way, retries, time_limit, depth):
        super().__init__(task, way, retries, time_limit, depth)
        self._pose = pose

    def _start(self):
        robot().drive(self._task, self._pose, **self._way)
