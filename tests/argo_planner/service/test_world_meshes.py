"""The meshes of a site for a page, read by a library that knows nothing of Argo."""

import io

import numpy as np
import pytest
import trimesh
import yourdfpy

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.errors import NotFound
from argo_env.robot.spec import robot_folder
from argo_env.site.shapes import Box, Role, half_extents
from argo_env.site.storeys import storeys
from argo_planner.service.world.meshes import Detail, checkpoint_mesh, floor_mesh, robot_mesh


def upright(content):
    """The parts of a GLB by name, z up again."""
    scene = trimesh.load(io.BytesIO(content), file_type="glb")
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    found = {}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        mesh = scene.geometry[geometry].copy()
        mesh.apply_transform(turned @ transform)
        # Of a node with several colours the library makes several, below it or named by numbers.
        name = node if node.split("_")[0] not in set(Role) else node.split("_")[0]
        found.setdefault(name, []).append(mesh)
    return found


def volume(solid, sides):
    if isinstance(solid, Box):
        return float(np.prod(solid.size))
    return sides / 2 * np.sin(2 * np.pi / sides) * solid.radius**2 * solid.length


def corners_of(content):
    return np.vstack([m.vertices for meshes in upright(content).values() for m in meshes])


@pytest.mark.parametrize("floor", range(1, 7))
def test_each_solid_of_a_floor_is_in_its_full_mesh(site, floor):
    found = upright(floor_mesh(site, floor))
    expected = {}
    for element in storeys(site.site)[floor]:
        expected.setdefault(element.role.value, []).extend(element.solids)
    assert set(found) == set(expected)
    for role, solids in expected.items():
        parts = [p for mesh in found[role] for p in mesh.split(only_watertight=False)]
        assert len(parts) == len(solids)
        assert sum(p.volume for p in parts) == pytest.approx(
            sum(volume(s, 24) for s in solids), rel=1e-4
        )
        where = np.array([s.center for s in solids])
        centers = np.array([p.bounds.mean(axis=0) for p in parts])
        for at in centers:
            assert np.abs(where - at).max(axis=1).min() < 1e-4


def test_the_floors_have_all_solids_of_the_site_and_none_twice(site):
    whole = sum(volume(s, 24) for e in site.site.elements for s in e.solids)
    drawn = sum(
        mesh.volume
        for floor in range(1, 7)
        for meshes in upright(floor_mesh(site, floor)).values()
        for mesh in meshes
    )
    assert drawn == pytest.approx(whole, rel=1e-4)


@pytest.mark.parametrize("detail", [Detail.MEDIUM, Detail.COARSE])
@pytest.mark.parametrize("floor", [1, 3])
def test_less_detail_is_smaller_and_as_large_in_space(site, floor, detail):
    full, less = floor_mesh(site, floor), floor_mesh(site, floor, detail)
    assert len(less) < 0.9 * len(full)
    all_of, some_of = upright(full), upright(less)
    assert set(all_of) == set(some_of)
    for role in all_of:
        for corner in (np.min, np.max):
            a, b = (
                corner([corner(m.vertices, axis=0) for m in meshes], axis=0)
                for meshes in (all_of[role], some_of[role])
            )
            assert np.abs(a - b).max() < 0.15


def test_stairs_have_each_step_and_rails_each_bar_in_the_coarse_mesh(site):
    found = upright(floor_mesh(site, 2, Detail.COARSE))
    elements = storeys(site.site)[2]
    steps = [s for e in elements if e.role is Role.STAIR for s in e.solids]
    assert sum(len(m.faces) for m in found["stair"]) == 4 * len(steps)
    tops = np.array([m for mesh in found["stair"] for m in mesh.triangles_center])
    for solid in steps:
        height = solid.center[2] + half_extents(solid)[2]
        near = np.abs(tops[:, :2] - solid.center[:2]).max(axis=1) < 1.0
        assert np.abs(tops[near, 2] - height).min() < 1e-3


def test_a_floor_that_is_not_there_is_refused(site):
    with pytest.raises(NotFound, match="no floor 9"):
        floor_mesh(site, 9)


def test_the_robot_is_as_large_as_its_footprint(site):
    corners = corners_of(robot_mesh(site))
    low, high = corners.min(axis=0), corners.max(axis=0)
    footprint = site.robot.footprint
    assert high[0] <= footprint.front + 0.01
    assert -low[0] <= footprint.rear + 0.01
    assert max(high[1], -low[1]) <= footprint.half_width + 0.01
    assert high[0] - low[0] > 0.8 * (footprint.front + footprint.rear)
    assert 0.2 < high[2] <= site.robot.driving_height + 0.01
    assert low[2] > -0.01


def test_each_link_of_the_robot_is_where_its_joints_put_it(site):
    model = yourdfpy.URDF.load(robot_folder() / site.robot.urdf, load_meshes=False)
    angles = {name: np.deg2rad(angle) for name, angle in site.robot.arm_stowed.items()}
    model.update_cfg(angles)
    scene = trimesh.load(io.BytesIO(robot_mesh(site)), file_type="glb")
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    for link in model.link_map:
        drawn = turned @ scene.graph[link][0]
        assert drawn == pytest.approx(model.get_transform(link), abs=1e-5), link


@pytest.mark.parametrize("kind", CheckpointKind)
def test_checkpoints_look_along_x(kind):
    corners = corners_of(checkpoint_mesh(kind))
    assert corners[:, 0].max() < 0.06
    assert np.ptp(corners, axis=0).max() < 0.6
