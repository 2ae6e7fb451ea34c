"""Measuring a checkpoint."""

from .action_state import ActionState
from .robot import robot


class MeasureState(ActionState):
    """Drives to a checkpoint and measures it.

    -- task             string    Name of the task.
    -- object_id        string    The checkpoint.
    -- retries          int       How often a failed action is tried again.
    -- depth            int       How many groups are around.
    -- joint_names      string[]  Joints to move.
    -- joint_positions  float[]   Their positions (rad or m).

    #> memory           dict      What the mission knows.

    <= done                       Measured, perhaps without a value.
    <= failed                     Not measured, all retries included.
    <= time_up                    The time of a group around is up.
    """

    def __init__(self, task, object_id, retries, depth, joint_names, joint_positions):
        super().__init__(task, retries, depth, joint_names, joint_positions)
        self._object_id = object_id

    def _begin(self, memory):
        robot().measure(self._task, self._object_id, memory["velocity"], *self._joints)

    def _done(self, memory, value):
        if value is not None:
            memory["values"][self._object_id] = value, robot().now()
