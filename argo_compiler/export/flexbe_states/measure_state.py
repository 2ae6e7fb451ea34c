"""Measuring a checkpoint."""

from .action_state import ActionState
from .robot import robot


class MeasureState(ActionState):
    """Drives to a checkpoint and measures it.

    -- task             string    Name of the task.
    -- object_id        string    The checkpoint.
    -- pose             float[]   Where the robot stands: x, y, z (m) and yaw (rad); or none.
    -- way              dict      How it goes there, as `Robot.measure` is told.
    -- reading_limit    float     s that it tries to read; 0.0: the robot's own.
    -- retries          int       How often a failed action is tried again.
    -- time_limit       float     s for each attempt; 0.0: no limit.
    -- depth            int       How many groups are around.

    #> memory           dict      What the mission knows.

    <= done                       Measured, perhaps without a value.
    <= failed                     Not measured, all retries included.
    <= time_up                    The time of a group around is up.
    """

    def __init__(self, task, object_id, pose, way, reading_limit, retries, time_limit, depth):
        super().__init__(task, way, retries, time_limit, depth)
        self._object_id = object_id
        self._pose = pose
        self._reading_limit = reading_limit

    def _begin(self):
        limit = self._reading_limit
        robot().measure(self._task, self._object_id, self._pose, limit, **self._way)

    def _done(self, memory, value):
        if value is None:
            self._failed(memory, "unreadable")
        else:
            number, abnormal = value if isinstance(value, tuple) else (value, False)
            memory["readings"][self._object_id] = "value", robot().now(), number, abnormal

    def _failed(self, memory, outcome):
        memory["readings"][self._object_id] = outcome, robot().now(), None, False
