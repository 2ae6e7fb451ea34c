"""Robots whose descriptions lack something: refused where they are made or opened, by name."""

import pytest
from pydantic import ValidationError

from argo_compiler.base.errors import Invalid
from argo_compiler.il import Mission, Task
from argo_env.planning.opening import open_site
from argo_env.robot.spec import RobotSpec, load_robot
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec


def without(joint: str, *poses: str) -> RobotSpec:
    """The tracker without a joint in some of the arm's poses."""
    robot = load_robot()
    left = {
        pose: {name: angle for name, angle in getattr(robot, pose).items() if name != joint}
        for pose in poses
    }
    return robot.model_copy(update=left)


@pytest.mark.parametrize("pose", ["arm_stowed", "arm_raised"])
def test_a_joint_that_only_one_pose_of_the_arm_has(pose: str):
    odd = without("arm_yaw", pose)
    with pytest.raises(ValidationError, match="in only one there are: arm_yaw"):
        RobotSpec(**dict(odd))
    with pytest.raises(Invalid, match="in only one there are: arm_yaw"):
        open_site("darmstadt", odd)


def test_a_joint_that_the_model_does_not_have():
    robot = load_robot()
    arm = {pose: {**getattr(robot, pose), "tail": 0.0} for pose in ("arm_stowed", "arm_raised")}
    with pytest.raises(Invalid, match=r"name joints of tracker\.urdf; it has no tail"):
        open_site("darmstadt", robot.model_copy(update=arm))
    with pytest.raises(Invalid, match=r"the robot's model rover\.urdf can't be read"):
        open_site("darmstadt", robot.model_copy(update={"urdf": "rover.urdf"}))


def test_an_arm_that_does_not_turn_reads_as_the_ideal_sensor_does_and_aims_no_camera():
    site = open_site("darmstadt", without("arm_yaw", "arm_stowed", "arm_raised"))
    mission = Mission(tasks=(Task(name="A", action="MEASURE", object_id="1"),))
    spec = RunSpec(mission=mission, site="darmstadt")
    assert simulate(spec, site).result.success
    with pytest.raises(Invalid, match="robot tracker has no arm_yaw: take the sensor `ideal`"):
        simulate(spec.model_copy(update={"sensor": "camera"}), site)
