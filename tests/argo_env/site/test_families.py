"""Generated sites have the requested properties, and the robot can drive on them."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_env.planning import open_site
from argo_env.planning.generated import generate_navigator
from argo_env.site import make_site
from argo_env.site.families import draw_site_and_slots
from argo_env.site.family import TEST_SEEDS, Family, Stairs, parse_family
from argo_env.site.norms import height_errors, violations
from argo_env.site.site_file import read_site_spec, to_yaml
from tests.conftest import examples

families = st.builds(
    Family,
    floors=st.integers(1, 12),
    size=st.tuples(st.integers(12, 40), st.integers(12, 40)),
    stairs=st.sampled_from(Stairs),
    clutter=st.floats(0.0, 1.0),
    checkpoints=st.integers(0, 60),
    seed=st.integers(0, 2 * TEST_SEEDS),
)
small_families = st.builds(
    Family,
    floors=st.integers(1, 3),
    size=st.tuples(st.integers(12, 14), st.integers(12, 13)),
    stairs=st.sampled_from(Stairs),
    clutter=st.sampled_from([0.0, 0.5, 1.0]),
    checkpoints=st.integers(1, 6),
    seed=st.integers(0, 2 * TEST_SEEDS),
)


@settings(max_examples=examples(60), deadline=None)
@given(family=families)
def test_a_draw_keeps_the_norms_and_has_the_requested_properties(family):
    spec, slots = draw_site_and_slots(family)
    assert violations(spec) == height_errors(spec) == []
    assert len(spec.floors) == family.floors
    ids = [c.id for floor in spec.floors for c in floor.checkpoints]
    assert ids == list(range(1, family.checkpoints + 1)) == list(slots)
    assert len(spec.towers) == (0 if family.floors == 1 else 1 + (family.stairs == Stairs.BOTH))
    for tower in spec.towers:
        assert all(0.16 <= f.rise <= 0.195 for f in tower.flights)
    assert draw_site_and_slots(family) == (spec, slots)
    # Checkpoints avoid refused slots.
    refused = set(list(slots.values())[:5])
    assert not refused & set(draw_site_and_slots(family, refused_slots=refused)[1].values())


@pytest.mark.long
@settings(max_examples=examples(5), deadline=None)
@given(family=small_families)
def test_every_place_is_reached_from_every_dock_and_back(family, robot, tmp_path_factory):
    navigator = generate_navigator(family)
    site = navigator.site
    assert generate_navigator(family).site.spec == site.spec
    file = tmp_path_factory.mktemp("generated") / "site.yaml"
    file.write_text(to_yaml(site.spec), encoding="utf-8")
    assert read_site_spec(file) == site.spec
    assert violations(site.spec) == height_errors(site.spec) == []
    for dock in site.docks.values():
        for floor in site.spec.floors:
            # In the north-west corner of every floor.
            goal = Pose(x=0.8, y=family.size[1] - 0.8, z=floor.z)
            there = navigator.plan(dock, goal)
            assert math.dist((there.end.x, there.end.y, there.end.z), (goal.x, goal.y, goal.z)) < 1
            assert navigator.plan(there.end, dock).end.yaw == pytest.approx(dock.yaw)
        for checkpoint in site.checkpoints:
            there = navigator.plan_to_view(dock, checkpoint.id)
            away = math.dist((there.end.x, there.end.y), checkpoint.position[:2])
            assert away <= robot.sensor.max_range + 0.2
            assert abs(there.end.z - site.spec.floors[checkpoint.floor - 1].z) < 0.1
            navigator.plan(there.end, dock)


def test_a_site_without_stairs_to_the_upper_floor_is_refused(monkeypatch):
    """`generate_navigator` checks the site that `draw_site_and_slots` returns."""

    def without_stairs(family, attempt=0, refused=()):
        spec, slots = draw_site_and_slots(family, attempt, refused)
        return spec.model_copy(update={"towers": ()}), slots

    monkeypatch.setattr("argo_env.planning.generated.draw_site_and_slots", without_stairs)
    monkeypatch.setattr("argo_env.planning.generated._LAYOUTS", 1)
    with pytest.raises(ArgoError, match="no draw of this seed can be driven"):
        generate_navigator(Family(floors=2, size=(12, 12), clutter=0.0, checkpoints=0, seed=5))


@pytest.mark.long
def test_checkpoints_that_can_not_be_read_are_moved(monkeypatch):
    """A checkpoint that is far too high in the first draw gets another slot."""

    def raised(family, attempt=0, refused=()):
        spec, slots = draw_site_and_slots(family, attempt, refused)
        if refused:
            return spec, slots
        (floor,) = spec.floors
        first, *others = floor.checkpoints
        away = first.model_copy(update={"position": (*first.position[:2], 8.0)})
        floor = floor.model_copy(update={"checkpoints": (away, *others)})
        return spec.model_copy(update={"floors": (floor,)}), slots

    family = Family(floors=1, size=(12, 12), clutter=0.0, checkpoints=3, seed=6)
    first_slot = draw_site_and_slots(family)[1][1]
    monkeypatch.setattr("argo_env.planning.generated.draw_site_and_slots", raised)
    navigator = generate_navigator(family)
    assert all(navigator.can_view(id) for id in (1, 2, 3))
    moved = draw_site_and_slots(family, refused_slots={first_slot})[0]
    assert navigator.site.spec == moved


@settings(max_examples=examples(50), deadline=None)
@given(family=families)
def test_text_form(family):
    family = family.model_copy(update={"clutter": round(family.clutter, 3)})
    assert parse_family(str(family)) == family


def test_text_form_with_defaults():
    assert parse_family("generated:") == Family()
    assert parse_family("generated:seed=7, floors=2") == Family(seed=7, floors=2)
    assert not Family(seed=TEST_SEEDS - 1).for_testing
    assert Family(seed=TEST_SEEDS).for_testing


@pytest.mark.parametrize(
    "text",
    ["floors=13", "floors=0", "floors=two", "size=20", "size=5x20", "size=20x41", "stairs=lift",
     "clutter=2", "clutter=nan", "checkpoints=501", "seed=-1", "heads=2", "floors",
     "seed=1,seed=2"],
)  # fmt: skip
def test_wrong_parameters_get_one_clear_message(text):
    with pytest.raises(ArgoError) as caught:
        open_site("generated:" + text)
    message = str(caught.value)
    assert text.split("=", maxsplit=1)[0].split(",")[0] in message
    assert "floors=1..12" in message
    assert "Input should" not in message
    assert "\n" not in message


def test_more_checkpoints_than_places():
    with pytest.raises(ArgoError, match="500 checkpoints do not fit"):
        open_site("generated:floors=1,size=12x12,checkpoints=500")


def test_norms_find_what_is_wrong():
    spec, _ = draw_site_and_slots(Family(floors=2, size=(14, 12), checkpoints=2, seed=1))
    tower = spec.towers[0]
    steep = tower.flights[0].model_copy(update={"going": 0.15, "width": 0.7})
    floor = spec.floors[0]
    far = floor.checkpoints[0].model_copy(update={"position": (3.0, -3.0, 2.3)})
    wrong = spec.model_copy(
        update={
            "towers": (tower.model_copy(update={"flights": (steep,)}),),
            "floors": (floor.model_copy(update={"checkpoints": (far,)}), *spec.floors[1:]),
        }
    )
    messages = "\n".join(violations(wrong))
    for text in ("pitch", "going", "wide", "2.3 m high", "2.5 m beside"):
        assert text in messages
    assert make_site(wrong).checkpoints
