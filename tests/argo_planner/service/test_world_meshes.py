"""Meshes of a site for the page, read by an independent library."""

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


def read_meshes(content):
    """Return the meshes of a GLB by their names, with z upwards."""
    scene = trimesh.load(io.BytesIO(content), file_type="glb")
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    meshes = {}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        mesh = scene.geometry[geometry].copy()
        mesh.apply_transform(turned @ transform)
        # The library splits a node with several colours into several, below it or numbered.
        name = node if node.split("_")[0] not in set(Role) else node.split("_")[0]
        meshes.setdefault(name, []).append(mesh)
    return meshes


def volume(solid, sides):
    if isinstance(solid, Box):
        return float(np.prod(solid.size))
    return sides / 2 * np.sin(2 * np.pi / sides) * solid.radius**2 * solid.length


def corners_of(content):
    return np.vstack([m.vertices for meshes in read_meshes(content).values() for m in meshes])


@pytest.mark.parametrize("floor", range(1, 7))
def test_each_solid_of_a_floor_is_in_its_full_mesh(site, floor):
    meshes = read_meshes(floor_mesh(site, floor))
    expected = {}
    for element in storeys(site.site)[floor]:
        expected.setdefault(element.role.value, []).extend(element.solids)
    assert set(meshes) == set(expected)
    for role, solids in expected.items():
        parts = [p for mesh in meshes[role] for p in mesh.split(only_watertight=False)]
        assert len(parts) == len(solids)
        assert sum(p.volume for p in parts) == pytest.approx(
            sum(volume(s, 24) for s in solids), rel=1e-4
        )
        where = np.array([s.center for s in solids])
        centers = np.array([p.bounds.mean(axis=0) for p in parts])
        for at in centers:
            assert np.abs(where - at).max(axis=1).min() < 1e-4


def test_the_floors_together_have_each_solid_of_the_site_once(site):
    whole = sum(volume(s, 24) for e in site.site.elements for s in e.solids)
    drawn = sum(
        mesh.volume
        for floor in range(1, 7)
        for meshes in read_meshes(floor_mesh(site, floor)).values()
        for mesh in meshes
    )
    assert drawn == pytest.approx(whole, rel=1e-4)


@pytest.mark.parametrize("detail", [Detail.MEDIUM, Detail.COARSE])
@pytest.mark.parametrize("floor", [1, 3])
def test_a_mesh_with_less_detail_is_a_smaller_file_of_the_same_extent(site, floor, detail):
    full, simple = floor_mesh(site, floor), floor_mesh(site, floor, detail)
    assert len(simple) < 0.9 * len(full)
    full_meshes, simple_meshes = read_meshes(full), read_meshes(simple)
    assert set(full_meshes) == set(simple_meshes)
    for role in full_meshes:
        for corner in (np.min, np.max):
            a, b = (
                corner([corner(m.vertices, axis=0) for m in meshes], axis=0)
                for meshes in (full_meshes[role], simple_meshes[role])
            )
            assert np.abs(a - b).max() < 0.15


def test_stairs_have_each_step_and_rails_each_bar_in_the_coarse_mesh(site):
    meshes = read_meshes(floor_mesh(site, 2, Detail.COARSE))
    elements = storeys(site.site)[2]
    steps = [s for e in elements if e.role is Role.STAIR for s in e.solids]
    assert sum(len(m.faces) for m in meshes["stair"]) == 4 * len(steps)
    tops = np.array([m for mesh in meshes["stair"] for m in mesh.triangles_center])
    for solid in steps:
        height = solid.center[2] + half_extents(solid)[2]
        near = np.abs(tops[:, :2] - solid.center[:2]).max(axis=1) < 1.0
        assert np.abs(tops[near, 2] - height).min() < 1e-3


def test_an_unknown_floor_is_refused(site):
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


def test_each_link_of_the_robot_has_the_pose_of_its_joints(site):
    model = yourdfpy.URDF.load(robot_folder() / site.robot.urdf, load_meshes=False)
    angles = {name: np.deg2rad(angle) for name, angle in site.robot.arm_stowed.items()}
    model.update_cfg(angles)
    scene = trimesh.load(io.BytesIO(robot_mesh(site)), file_type="glb")
    turned = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    for link in model.link_map:
        drawn = turned @ scene.graph[link][0]
        assert drawn == pytest.approx(model.get_transform(link), abs=1e-5), link


@pytest.mark.parametrize("kind", CheckpointKind)
def test_checkpoints_face_along_x(kind):
    corners = corners_of(checkpoint_mesh(kind))
    assert corners[:, 0].max() < 0.06
    assert np.ptp(corners, axis=0).max() < 0.6
