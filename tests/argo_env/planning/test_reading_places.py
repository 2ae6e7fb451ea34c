"""Where the checkpoints of a mission are read from, for tools that have to be told."""

import json
import math

import pytest

from argo_compiler.hfsm import lower
from argo_compiler.il import Action, Mission, Task
from argo_compiler.isar import from_isar, to_isar
from argo_env.planning.reading_places import inspection_views


def test_views_are_places_that_the_robot_reads_from(shipped, navigator):
    mission = shipped("mission_1.txt", start_area=1, end_area=2).mission
    views = inspection_views(mission, navigator)
    measured = [task.object_id for task in mission.tasks if task.action is Action.MEASURE]
    assert list(views) == measured
    for id, view in views.items():
        checkpoint = navigator.site.checkpoint(int(id))
        assert (view.target, view.name) == (checkpoint.position, checkpoint.name)
        path = navigator.plan_to_view(view.pose, int(id))
        assert path.length == pytest.approx(0, abs=0.3)  # it is a good place already
        assert math.dist(view.target[:2], (view.pose.x, view.pose.y)) < 3
    back = from_isar(json.loads(to_isar(mission, lower(mission), views)), "isar")
    assert [t.object_id for t in back.mission.tasks] == [t.object_id for t in mission.tasks]


def test_unknown_checkpoints_have_no_view(navigator):
    task = Task(name="A", action=Action.MEASURE, object_id="none")
    assert inspection_views(Mission(tasks=(task,)), navigator) == {}
