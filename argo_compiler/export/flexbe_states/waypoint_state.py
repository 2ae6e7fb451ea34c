"""Driving to a pose."""

from .action_state import ActionState
from .robot import robot


class WaypointState(ActionState):
    """Drives to a pose.

    -- task             string    Name of the task.
    -- pose             float[]   x, y, z (m) and yaw (rad).
    -- retries          int       How often a failed action is tried again.
    -- depth            int       How many groups are around.
    -- joint_names      string[]  Joints to move.
    -- joint_positions  float[]   Their positions (rad or m).

    #> memory           dict      What the mission knows.

    <= done                       Arrived.
    <= failed                     Not arrived, all retries included.
    <= time_up                    The time of a group around is up.
    """

    def __init__(self, task, pose, retries, depth, joint_names, joint_positions):
        super().__init__(task, retries, depth, joint_names, joint_positions)
        self._pose = pose

    def _begin(self, memory):
        robot().drive(self._task, self._pose, memory["velocity"], *self._joints)
