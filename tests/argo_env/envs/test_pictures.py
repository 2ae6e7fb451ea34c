"""Pictures of routes and inspections: what is in them, and that they change nothing."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from PIL import ImageColor

from argo_env.envs.drawing.floors import aisles, open_floors, plans_of
from argo_env.envs.drawing.plan import Marker, Scene, Station, draw_scene
from argo_env.envs.drawing.sheet import FINER, FOOT, HEAD, SIZE, make_sheet
from argo_env.envs.drawing.spots import Spots
from argo_env.envs.drawing.style import ROBOT, STYLES
from argo_env.envs.drawing.way import Moment, lines
from argo_env.envs.inspection import InspectEnv
from argo_env.envs.route import RouteEnv, RouteVectorEnv
from argo_env.envs.route_instance import make_instance
from argo_env.site.shapes import Role
from tests.argo_env.envs import rollouts
from tests.conftest import examples

SHAPE = (SIZE[1], SIZE[0], 3)


def near(picture, sheet, x, y, floor, radius=12):
    """The part of a picture about a point of a floor."""
    column, row = (round(v / FINER) for v in sheet.at(x, y, floor))
    return picture[row - radius : row + radius, column - radius : column + radius]


def has(part, colour):
    """Whether a colour is in a part of a picture, but for what smoothing does."""
    wanted = np.array(ImageColor.getrgb(colour) if isinstance(colour, str) else colour)
    return bool((np.abs(part.astype(int) - wanted).max(axis=-1) <= 3).any())


def differs(one, other):
    return bool((one != other).any())


def scene(**changed):
    parts = {
        "headline": "10 s",
        "markers": [],
        "stations": [],
        "way": [Moment(0.0, 15.0, 15.0, 1)],
        "heading": None,
        "legend": {},
    }
    return Scene(**(parts | changed))


@settings(max_examples=examples(60), deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(1, 60), st.floats(1, 60), st.floats(-50, 50)), min_size=1, max_size=14
    )
)
def test_floors_are_apart_and_in_the_picture(sizes):
    plans = [
        plan
        for number, (width, depth, x) in enumerate(sizes, start=1)
        for plan in open_floors([(x, x), (x + width, x + depth)], [number])
    ]
    sheet = make_sheet(plans)
    assert list(sheet.panels) == list(range(1, len(sizes) + 1))
    boxes = [(p.left, p.top, p.left + p.width, p.top + p.height) for p in sheet.panels.values()]
    for left, top, right, bottom in boxes:
        assert 0 <= left < right <= SIZE[0] * FINER
        assert HEAD * FINER <= top < bottom <= (SIZE[1] - FOOT) * FINER + 1
    for k, a in enumerate(boxes):
        for b in boxes[k + 1 :]:
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
    for panel in sheet.panels.values():
        x0, y0, x1, y1 = panel.plan.bounds
        assert sheet.at(x0, y1, panel.plan.number) == (panel.left, panel.top)
        right, bottom = sheet.at(x1, y0, panel.plan.number)
        assert abs(right - panel.left - panel.width) <= 1
        assert abs(bottom - panel.top - panel.height) <= 1


@settings(max_examples=examples(40), deadline=None)
@given(st.lists(st.tuples(st.floats(0, 30), st.floats(0, 20)), min_size=1, max_size=12))
@example([(0.0, 0.0)] * 12)
@example([(30.0, 20.0)] * 12)
def test_discs_do_not_cover_one_another(points):
    spots = Spots(sheet := make_sheet(aisles(30.0, 20.0, 1)))
    half = 11.0 * FINER
    placed = [spots.nearest(sheet.at(x, y, 1), half, half, 1) for x, y in points]
    assert placed[0] == sheet.at(*points[0], 1)
    for k, (x, y) in enumerate(placed):
        assert all(max(abs(x - a), abs(y - b)) >= 2 * half for a, b in placed[k + 1 :])


def test_plans_show_the_site(navigator):
    plans = plans_of(navigator)
    assert [plan.number for plan in plans] == [f.number for f in navigator.site.spec.floors]
    for plan in plans:
        roles = {role for role, _ in plan.shapes}
        assert {Role.DECK, Role.RAILING} <= roles
        assert (Role.STAIR in roles) == (plan.number < len(plans))
        x0, y0, x1, y1 = plan.bounds
        for c in navigator.site.checkpoints:
            if c.floor == plan.number:
                assert x0 <= c.position[0] <= x1
                assert y0 <= c.position[1] <= y1
    for pose in navigator.site.docks.values():
        x0, y0, x1, y1 = plans[0].bounds
        assert x0 + 0.5 <= pose.x <= x1 - 0.5
        assert y0 + 0.5 <= pose.y <= y1 - 0.5


def test_states_look_different():
    sheet = make_sheet(aisles(30.0, 20.0, 2))
    pictures = {
        state: near(
            draw_scene(sheet, scene(markers=[Marker(5.0, 5.0, 2, "7", state)])), sheet, 5, 5, 2
        )
        for state in STYLES
    }
    for state, part in pictures.items():
        assert has(part, STYLES[state].fill)
        assert all(differs(part, other) for name, other in pictures.items() if name != state)
    chosen = scene(markers=[Marker(5.0, 5.0, 2, "7", "open", chosen=True)])
    assert has(near(draw_scene(sheet, chosen), sheet, 5, 5, 2, 18), ROBOT)
    other = scene(markers=[Marker(5.0, 5.0, 2, "8", "open")])
    assert differs(near(draw_scene(sheet, other), sheet, 5, 5, 2), pictures["open"])


def test_the_name_of_a_dock_is_not_covered():
    """By the robot, the way or the checkpoints: it is there as a whole, in every such picture."""
    sheet = make_sheet(aisles(30.0, 20.0, 1))
    dock = Station(15.0, 10.0, 1, "dock")
    crowd = [Marker(15.0 + dx, 10.0 + dy, 1, "9", "open") for dx in (-1, 1, 2) for dy in (-1, 0, 1)]
    way = [Moment(0.0, 15.0, 10.0, 1), Moment(5.0, 25.0, 10.0, 1), Moment(10.0, 15.0, 10.0, 1)]
    alone = draw_scene(sheet, scene(stations=[dock], headline=""))
    full = draw_scene(
        sheet, scene(stations=[dock], headline="", markers=crowd, way=way, heading=1.0)
    )
    plate = near(alone, sheet, 15.0, 10.0, 1, 40)[:, 49:88]  # at the right of its mark
    rows, columns = np.nonzero((plate == 255).all(axis=-1))
    plate = plate[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    height, width, _ = plate.shape
    found = [
        (row, column)
        for row in range(SHAPE[0] - height)
        for column in np.flatnonzero((full[row, : SHAPE[1] - width] == plate[0, 0]).all(axis=-1))
        if not differs(full[row : row + height, column : column + width], plate)
    ]
    assert found


def test_the_way_is_drawn_between_floors():
    sheet = make_sheet(aisles(30.0, 20.0, 2))
    stay = [Moment(0.0, 20.0, 10.0, 1), Moment(50.0, 5.0, 10.0, 1)]
    climb = [*stay, Moment(60.0, 5.0, 4.0, 2), Moment(90.0, 25.0, 4.0, 2)]
    drawn = lines(sheet, climb)
    assert len(drawn) == 2  # no line from floor to floor
    for line, number in zip(drawn, (1, 2), strict=True):
        panel = sheet.panels[number]
        assert (line.points[:, 0] >= panel.left).all()
        assert (line.points[:, 0] <= panel.left + panel.width).all()
        assert all(a <= b for a, b in pairwise(line.shades))
    before, after = (draw_scene(sheet, scene(way=way)) for way in (stay, climb))
    # A mark at the upper end and at the lower one, with a sign in white.
    for floor, y in ((1, 10.0), (2, 4.0)):
        part = near(after, sheet, 5.0, y, floor, 30)
        assert differs(part, near(before, sheet, 5.0, y, floor, 30))


@pytest.fixture(scope="module")
def inspect():
    env = InspectEnv(faults=0, render_mode="rgb_array")
    yield env
    env.close()


def test_an_inspection_is_drawn_as_it_is(inspect, navigator):
    inspect.reset(seed=2, options={})
    before = inspect.render()
    assert before.shape == SHAPE
    assert before.dtype == np.uint8
    sheet = make_sheet(plans_of(navigator))
    c = navigator.site.checkpoints[5]
    place = (c.position[0], c.position[1], c.floor)
    assert has(near(before, sheet, *place), STYLES["open"].fill)
    inspect.step(5)
    after = inspect.render()
    assert not differs(after, inspect.render())
    part = near(after, sheet, *place, 24)
    assert has(part, STYLES["done"].fill)
    assert has(part, ROBOT)  # the ring of the checkpoint that was chosen last


def test_an_inspection_shows_the_chosen_floors(inspect):
    pictures = []
    for options in ({}, {"floor": 1}, {"floor": [1, 2]}, {"floor": 2}):
        inspect.reset(seed=2, options=options)
        pictures.append(inspect.render())
    assert all(differs(a, b) for a, b in pairwise(pictures))
    # Fewer floors are drawn larger: what is below the first row is empty paper.
    assert (pictures[1][HEAD:, -20:] == 255).mean() > 0.8
    inspect.reset(seed=2, options={})


def test_the_trail_of_an_inspection_is_the_way_that_it_drove(inspect, navigator):
    inspect.reset(seed=2, options={})
    inspect.step(12)
    trail = inspect._run.trail
    assert trail[-1] == (inspect._run.now, inspect._run.pose)
    times = [t for t, _ in trail]
    assert times == sorted(times)
    assert all(
        np.hypot(b.x - a.x, b.y - a.y) < 0.3 and abs(b.z - a.z) < 0.3
        for (_, a), (_, b) in pairwise(trail)
    )
    floors = {navigator.site.floor_at(p.z) for _, p in trail}
    assert floors == set(range(1, navigator.site.checkpoints[12].floor + 1))


def test_rendering_changes_no_rollout(yard_file):
    for kind, arguments in ((InspectEnv, {"scenario": yard_file}), (RouteEnv, {})):
        heard = []
        for looks in (False, True):
            env = kind(**arguments, render_mode="rgb_array")
            if looks:
                step = env.step

                def seen(action, env=env, step=step):
                    env.render()
                    outcome = step(action)
                    env.render()
                    return outcome

                env.step = seen
            heard.append(rollouts.digest(rollouts.rollout(env, 4, 6)))
            env.close()
        assert heard[0] == heard[1]


@pytest.mark.parametrize("scenario", ["random", "umad"])
def test_a_route_is_drawn_as_it_is(scenario):
    env = RouteEnv(scenario=scenario, render_mode="rgb_array")
    env.reset(seed=0)
    before = env.render()
    env.step(int(np.flatnonzero(env.action_masks())[-1]))
    after = env.render()
    assert before.shape == after.shape == SHAPE
    assert differs(before, after)
    assert has(after, STYLES["done"].fill)
    env.step(0)
    assert differs(after, env.render())
    other = RouteEnv(scenario=scenario, render_mode="rgb_array")
    other.set_state(env.get_state())
    assert not differs(other.render(), env.render())


def test_routes_show_the_chosen_floors():
    env = RouteEnv(render_mode="rgb_array")
    env.reset(seed=0, options={"floor": [1, 3]})
    sheet = make_sheet(aisles(30.0, 20.0, 3))
    x, y, _ = next(p for p in env.instance.places[1:-1].tolist() if p[2] == 2)
    part = near(env.render(), sheet, x, y, 2)
    assert has(part, STYLES["outside"].rim)
    assert not has(part, STYLES["open"].fill)


class ThreeInALine:
    """Instances of one's own: of their site nothing is known."""

    checkpoints, floors = 3, 2

    def draw(self, *_):
        places = np.array([[0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 0, 2], [0, 0, 1]], dtype=float)
        times = np.abs(np.subtract.outer(places[:, 0], places[:4, 0])) + 1.0
        prizes = np.array([0.0, 0.5, 0.5, 0.5])
        return make_instance(times, np.zeros(4), prizes, [], 100.0, places)


def test_routes_of_ones_own_are_drawn():
    env = RouteEnv(source=ThreeInALine(), render_mode="rgb_array")
    env.reset(seed=0)
    pictures = [env.render()]
    for node in (1, 3, 0):
        env.step(node)
        pictures.append(env.render())
    assert all(picture.shape == SHAPE for picture in pictures)
    assert all(differs(a, b) for a, b in pairwise(pictures))


def test_a_batch_draws_each_route():
    batch = RouteVectorEnv(2, checkpoints=5, render_mode="rgb_array")
    observation, _ = batch.reset(seed=1)
    batch.step(np.array([int(np.flatnonzero(mask)[-1]) for mask in observation["mask"]]))
    one, other = batch.render()
    assert one.shape == other.shape == SHAPE
    assert differs(one, other)
    assert has(one, STYLES["done"].fill)


def test_a_window_shows_the_state_after_the_step(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")  # windows are drawn in memory
    env = RouteEnv(checkpoints=5, render_mode="human")
    shown = []
    monkeypatch.setattr("argo_env.envs.rendering.Window.show", lambda _, p: shown.append(p))
    env.reset(seed=0)
    env.step(int(np.flatnonzero(env.action_masks())[-1]))
    env.render_mode = "rgb_array"
    assert not differs(shown[-1], env.render())
    assert differs(*shown)
    env.close()
