"""Interface that the robot's side must implement: a clock, and one action at a time."""


class Robot:
    """Base class of the robot's side; pass an object of a derived class to `connect`.

    All times are in seconds.
    """

    def now(self):
        """Return the time of a clock that never runs backwards."""
        raise NotImplementedError

    def measure(self, task, object_id, pose, reading_limit, velocity, joints):
        """Start to drive to a checkpoint and to measure it.

        `pose` is the robot's pose for the measurement, as in `drive`; []: the robot chooses a pose
        from which it sees the checkpoint. `reading_limit` is the time in s for trying to read;
        0.0: the robot's own limit. `velocity` and `joints` are as in `drive`.
        """
        raise NotImplementedError

    def drive(self, task, pose, velocity, joints):
        """Start to drive to a pose: x, y, z (m) and yaw (rad).

        `velocity` is in m/s; 0.0: the robot's own speed. `joints` is the target state of joints: a
        dictionary with `names`, `positions`, `velocities` and `efforts`, or {}.
        """
        raise NotImplementedError

    def result(self):
        """Return None while the action runs, then its outcome, and its value or None.

        The outcome is 'done', 'failed', or for a measurement 'unreadable' if the robot could not
        read the checkpoint, and 'unreachable' if it could not get to it. The value is a
        number, or a tuple of a number and a bool that is True if the number is abnormal.
        """
        raise NotImplementedError

    def cancel(self):
        """Stop the running action, and return when its clean-up is complete."""
        raise NotImplementedError


_connected = []


def connect(robot):
    """Set the robot that all behaviours of this process drive."""
    _connected[:] = [robot]


def robot():
    """Return the connected robot. Raises RuntimeError if there is none."""
    if not _connected:
        raise RuntimeError("no robot is connected: call argo_flexbe_states.robot.connect first")
    return _connected[0]
