"""What the robot's side has to provide: a clock, and one action at a time."""


class Robot:
    """Derive from it and hand an object to `connect`. Times are seconds."""

    def now(self):
        """The time on a clock that never runs backwards."""
        raise NotImplementedError

    def measure(self, task, object_id, pose, reading_limit, velocity, joints):
        """Begins to drive to a checkpoint and to measure it.

        `pose`: where it stands then, as in `drive`; [] : where it sees the checkpoint from.
        `reading_limit` is s that it tries to read, 0.0: the robot's own.
        """
        raise NotImplementedError

    def drive(self, task, pose, velocity, joints):
        """Begins to drive to a pose: x, y, z (m) and yaw (rad).

        `velocity` is m/s, 0.0: the robot's own. `joints` is where joints are to be: a dictionary
        with `names`, `positions`, `velocities` and `efforts`, or {}.
        """
        raise NotImplementedError

    def result(self):
        """None while the action runs; then how it ended, and the value or None.

        How: 'done', 'failed', or 'unreadable' if a measurement failed as it could not read. The
        value is a number, or a number and whether it is abnormal.
        """
        raise NotImplementedError

    def cancel(self):
        """Stops the action that runs; returns when its clean-up is done."""
        raise NotImplementedError


_connected = []


def connect(robot):
    """Says which robot all behaviours of this process drive."""
    _connected[:] = [robot]


def robot():
    """The robot that is connected."""
    if not _connected:
        raise RuntimeError("no robot is connected: call argo_flexbe_states.robot.connect first")
    return _connected[0]
