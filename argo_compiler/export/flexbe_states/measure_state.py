"""State that measures a checkpoint."""

from .action_state import ActionState
from .robot import robot


class MeasureState(ActionState):
    """State that drives to a checkpoint and measures it.

    -- task             string    Name of the task.
    -- object_id        string    Id of the checkpoint.
    -- pose             float[]   Robot's pose: x, y, z (m) and yaw (rad); []: chosen by the robot.
    -- way              dict      Arguments `velocity` and `joints` of `Robot.measure`.
    -- reading_limit    float     Time in s for trying to read; 0.0: the robot's own limit.
    -- retries          int       Number of retries after a failed action.
    -- time_limit       float     Time in s for each attempt; 0.0: no limit.
    -- depth            int       Number of groups that contain the state.

    #> memory           dict      State of the mission, shared by its states.

    <= done                       Measured, perhaps without a value.
    <= failed                     Not measured, all retries included.
    <= time_up                    The time of a containing group is up.
    """

    def __init__(self, task, object_id, pose, way, reading_limit, retries, time_limit, depth):
        super().__init__(task, way, retries, time_limit, depth)
        self._object_id = object_id
        self._pose = pose
        self._reading_limit = reading_limit

    def _start(self):
        limit = self._reading_limit
        robot().measure(self._task, self._object_id, self._pose, limit, **self._way)

    def _record_result(self, memory, value):
        if value is None:
            self._record_failure(memory, "unreadable")
        else:
            number, abnormal = value if isinstance(value, tuple) else (value, False)
            memory["readings"][self._object_id] = "value", robot().now(), number, abnormal

    def _record_failure(self, memory, outcome):
        memory["readings"][self._object_id] = outcome, robot().now(), None, False
