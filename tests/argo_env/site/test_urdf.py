"""The written URDF is read by PyBullet and by yourdfpy."""

from collections import Counter

import numpy as np
import pytest
import yourdfpy

from argo_env.site import load_site
from argo_env.site.shapes import Box, Cylinder, half_extents
from argo_env.site.urdf import COLOURS, to_urdf


@pytest.fixture(scope="module")
def model(umad_urdf):
    return yourdfpy.URDF.load(
        str(umad_urdf),
        build_collision_scene_graph=True,
        load_collision_meshes=True,
        force_collision_mesh=False,
    )


def test_lines_are_short_enough_for_pybullet(umad_urdf):
    assert max(map(len, umad_urdf.read_text(encoding="utf-8").splitlines())) < 1024


def test_writing_is_deterministic(umad):
    again = load_site("umad")
    assert to_urdf(again.name, again.elements) == to_urdf(umad.name, umad.elements)


def test_as_many_solids_in_every_reader(umad, model, umad_world):
    wanted = Counter()
    for element in umad.elements:
        wanted[element.material] += len(element.solids)
    links = {link.name: link for link in model.robot.links}
    assert {n: len(k.visuals) for n, k in links.items() if k.visuals} == wanted
    assert {n: len(k.collisions) for n, k in links.items() if k.collisions} == wanted
    visuals = Counter(v[1] for v in umad_world.ask("getVisualShapeData", umad_world.body))
    assert set(umad_world.links) == set(wanted)
    assert {name: visuals[link] for name, link in umad_world.links.items()} == wanted
    assert len(model.collision_scene.geometry) == sum(wanted.values())


def test_solids_are_named_after_their_elements(umad, model):
    names = [v.name for link in model.robot.links for v in link.visuals]
    assert len(set(names)) == len(names)
    assert {name.rpartition(" #")[0] for name in names} == {e.name for e in umad.elements}


def test_same_bounding_box_in_every_reader(umad, model, umad_world):
    solids = [s for e in umad.elements for s in e.solids]
    low = np.min([np.array(s.center) - half_extents(s) for s in solids], axis=0)
    high = np.max([np.array(s.center) + half_extents(s) for s in solids], axis=0)
    assert model.scene.bounds == pytest.approx(np.array([low, high]), abs=0.005)
    assert model.collision_scene.bounds == pytest.approx(np.array([low, high]), abs=0.005)
    boxes = np.array(
        [umad_world.ask("getAABB", umad_world.body, n) for n in umad_world.links.values()]
    )
    # PyBullet adds a contact margin to its boxes.
    assert boxes[:, 0].min(axis=0) == pytest.approx(low, abs=0.05)
    assert boxes[:, 1].max(axis=0) == pytest.approx(high, abs=0.05)


def test_each_material_has_its_colour(model, umad_world):
    for material in model.robot.materials:
        assert material.color.rgba == pytest.approx([*COLOURS[material.name], 1.0])
    for shape in umad_world.ask("getVisualShapeData", umad_world.body):
        (material,) = (m for m, link in umad_world.links.items() if link == shape[1])
        assert shape[7] == pytest.approx((*COLOURS[material], 1.0), abs=1e-3)


def test_every_material_of_a_site_has_a_colour(umad):
    assert {e.material for e in umad.elements} <= set(COLOURS)


def test_solids_are_where_the_site_has_them(umad, model):
    written = {v.name: v for link in model.robot.links for v in link.collisions}
    for element in umad.elements:
        for number, solid in enumerate(element.solids):
            part = written[f"{element.name} #{number}"]
            assert part.origin[:3, 3] == pytest.approx(solid.center, abs=1e-5)
            assert part.origin[:3, :3] == pytest.approx(solid.rotation(), abs=1e-5)
            if isinstance(solid, Box):
                assert part.geometry.box.size == pytest.approx(solid.size, abs=1e-5)
            else:
                assert isinstance(solid, Cylinder)
                assert part.geometry.cylinder.radius == pytest.approx(solid.radius, rel=1e-5)
                assert part.geometry.cylinder.length == pytest.approx(solid.length, rel=1e-5)
