"""The catalogue of UMAD: the site as scripts see it."""

import itertools
import json
import math

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.hfsm import lower
from argo_compiler.il import Action, Mission, Task
from argo_compiler.isar import from_isar, to_isar
from argo_env.files.parts import Parts
from argo_env.navigation import Navigator
from argo_env.planning.catalog import load_catalog, make_catalog
from argo_env.planning.inspection_views import inspection_views_by_object_id
from argo_env.site import make_site
from tests.whole_scripts import import_whole
from tests.yard import site_of


def test_six_floors(catalog):
    assert [(f.number, f.z) for f in catalog.floors] == [(n, 2.5 * (n - 1)) for n in range(1, 7)]


def test_checkpoints_are_the_sites(catalog, umad):
    assert [c.id for c in catalog.checkpoints] == list(range(1, 21))
    for info in catalog.checkpoints:
        checkpoint = umad.checkpoint(info.id)
        for name in ("kind", "name", "floor", "unit", "range", "nominal"):
            assert getattr(info, name) == getattr(checkpoint, name)


def test_plant_tags_of_the_site_are_in_the_catalogue(umad, navigator):
    spec = umad.spec.model_dump(mode="json")
    spec["floors"][0]["checkpoints"][0]["tags"] = ["20-PI-1034A"]
    site = make_site(type(umad.spec).model_validate(spec))
    (first, *others) = load_catalog(site, navigator.parts).checkpoints
    assert first.tags == ("20-PI-1034A",)
    assert not any(one.tags for one in others)


def test_areas_and_places(catalog, umad):
    assert {a.number: a.dock for a in catalog.areas} == umad.docks
    assert {p.name: p.pose for p in catalog.places} == umad.places
    assert catalog.site == "umad"


@pytest.mark.parametrize("number", range(1, 7))
def test_patrol_is_a_round_near_the_corners(catalog, umad, number):
    floor = catalog.floor(number)
    assert len(floor.patrol) >= 3
    rects = [
        r for name, r in umad.spec.floors[number - 1].walkways.items() if name != "cross aisle"
    ]
    corners = list(
        itertools.product(
            (min(r[0] for r in rects), max(r[2] for r in rects)),
            (min(r[1] for r in rects), max(r[3] for r in rects)),
        )
    )
    nearest = [min(corners, key=lambda c: math.dist(c, (p.x, p.y))) for p in floor.patrol]
    assert len(set(nearest)) == len(floor.patrol)
    for pose, corner, following in zip(
        floor.patrol, nearest, floor.patrol[1:] + floor.patrol[:1], strict=True
    ):
        assert math.dist(corner, (pose.x, pose.y)) <= 2.5
        assert pose.z == pytest.approx(floor.z, abs=0.01)
        ahead = math.atan2(following.y - pose.y, following.x - pose.x)
        assert pose.yaw == pytest.approx(ahead, abs=1e-6)
    # Counter-clockwise: the enclosed area is positive.
    points = [(p.x, p.y) for p in floor.patrol]
    edges = zip(points, points[1:] + points[:1], strict=True)
    assert sum(a * d - b * c for (a, b), (c, d) in edges) > 0


@pytest.mark.parametrize("number", range(1, 7))
def test_patrol_goes_all_round(catalog, navigator, number):
    """Each pose leads to the next, and the last to the first: all reach each other."""
    poses = catalog.floor(number).patrol
    for a, b in zip(poses, poses[1:] + poses[:1], strict=True):
        end = navigator.plan(a, b).end
        assert math.dist((end.x, end.y, end.z), (b.x, b.y, b.z)) <= 0.05


def test_catalogue_goes_through_json(catalog):
    assert Catalog.model_validate_json(catalog.model_dump_json()) == catalog


def test_same_site_same_catalogue(catalog, navigator):
    assert make_catalog(navigator) == catalog


def test_floor_that_is_too_small_to_patrol(robot, tmp_path):
    nook = site_of(
        name="nook",
        ground=(0, 0, 6, 6),
        floors=[{"number": 1, "z": 0.0, "railed": False, "walkways": {"a": [2, 2, 4, 4]}}],
        areas=[{"number": 1, "dock": [3.05, 3.05, 0]}],
    )
    navigator = Navigator(nook, robot, Parts(tmp_path, "nook"))
    catalog = make_catalog(navigator)
    assert catalog.floor(1).patrol == ()
    assert load_catalog(nook, navigator.parts) == catalog
    begin = "Mission Protocol\n1. Set the starting point in starting area 1.\n"
    for sentence in ("2. Patrol floor 1.", "2. Go to floor 1."):
        with pytest.raises(DiagnosticError, match="floor 1 has no three places that the robot"):
            import_whole(begin + sentence, catalog, source_name="nook.txt")
    import_whole(begin + "2. Wait 5 s.", catalog, source_name="nook.txt")


def test_views_are_places_that_the_robot_reads_from(shipped, navigator):
    mission = shipped("mission_1.txt", start_area=1, end_area=2).mission
    views = inspection_views_by_object_id(mission, navigator)
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
    assert inspection_views_by_object_id(Mission(tasks=(task,)), navigator) == {}
