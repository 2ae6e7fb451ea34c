"""Tests of the exporters for ROS formats."""

import pytest

from argo_compiler.export import EXPORTERS, ExportInput
from argo_compiler.hfsm import lower
from argo_compiler.il import Action, Mission, Task
from argo_compiler.ros import message_package, read_bag

PLAN = Mission(tasks=(Task(name="A", action=Action.MEASURE, object_id="4"),))


@pytest.mark.parametrize("name", ["ros1-bag", "ros2-bag", "ros2-mcap"])
def test_bags_have_the_form_that_the_exporter_declares(tmp_path, name):
    exporter = EXPORTERS[name]
    exported = exporter.export(ExportInput(PLAN, lower(PLAN)))
    path = tmp_path / ("plan" + "".join(exporter.suffixes))
    if exporter.suffixes:
        path.write_bytes(exported)
    else:
        path.mkdir()
        for file, content in exported.items():
            (path / file).write_bytes(content)
    assert read_bag(path).mission == PLAN


def test_the_package_does_not_depend_on_the_mission():
    exported = EXPORTERS["ros-package"].export(ExportInput(PLAN, lower(PLAN)))
    assert exported == message_package()
    assert "msg/MissionSpecification.msg" in exported
