"""What the robot's side has to provide: a clock, and one action at a time."""


class Robot:
    """Derive from it and hand an object to `connect`. Times are seconds."""

    def now(self):
        """The time on a clock that never runs backwards."""
        raise NotImplementedError

    def measure(self, task, object_id, velocity, joint_names, joint_positions):
        """Begins to drive to a checkpoint and to measure it. `velocity` 0.0: the robot's own."""
        raise NotImplementedError

    def drive(self, task, pose, velocity, joint_names, joint_positions):
        """Begins to drive to a pose: x, y, z (m) and yaw (rad)."""
        raise NotImplementedError

    def result(self):
        """None while the action runs; then 'failed', or 'done' and the value or None."""
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
