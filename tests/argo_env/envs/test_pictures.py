"""Pictures of episodes: they show the state, and drawing them changes nothing."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from PIL import ImageColor, ImageDraw

from argo_env.envs.drive import DriveEnv
from argo_env.envs.inspection import InspectEnv
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_batch import RouteVectorEnv
from argo_env.envs.route_instance import make_instance
from argo_env.pictures.drawing.floors import empty_floor_plans, floor_plans, rectangular_floor_plans
from argo_env.pictures.drawing.label_placement import LabelPlacer
from argo_env.pictures.drawing.path import PathPoint, draw_lines_with_arrows, path_lines
from argo_env.pictures.drawing.plan import Marker, PlanDrawing, StationMark, draw_plan
from argo_env.pictures.drawing.sheet import FINER, FOOT, HEAD, SIZE, make_sheet
from argo_env.pictures.drawing.style import POINT, ROBOT, STYLES
from argo_env.pictures.drive import GOAL
from argo_env.report.track import colour
from argo_env.robot.spec import Footprint
from argo_env.site.shapes import Role
from tests.argo_env.envs import rollouts
from tests.conftest import examples

SHAPE = (SIZE[1], SIZE[0], 3)


def near(picture, sheet, x, y, floor, radius=12):
    """Return the part of a picture around a point of a floor."""
    column, row = (round(v / FINER) for v in sheet.pixel_at(x, y, floor))
    return picture[row - radius : row + radius, column - radius : column + radius]


def has(part, colour):
    """Return True if a colour is in a part of a picture, with a tolerance for smoothing."""
    wanted = np.array(ImageColor.getrgb(colour) if isinstance(colour, str) else colour)
    return bool((np.abs(part.astype(int) - wanted).max(axis=-1) <= 3).any())


def differs(one, other):
    return bool((one != other).any())


def draw(sheet, **changed):
    """Return a picture of a plan with little on it, except for what is changed."""
    parts = {
        "headline": "10 s",
        "markers": [],
        "stations": [],
        "path": [PathPoint(0.0, 15.0, 15.0, 1)],
        "heading": 0.0,
        "footprint": None,
        "legend": {},
    }
    return draw_plan(sheet, PlanDrawing(**(parts | changed)))


def legend_of(picture):
    """Return the legend at the bottom of a picture, without the scale."""
    return picture[-FOOT:, : SIZE[0] - 200]


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
        for plan in empty_floor_plans([(x, x), (x + width, x + depth)], [number])
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
        assert sheet.pixel_at(x0, y1, panel.plan.number) == (panel.left, panel.top)
        right, bottom = sheet.pixel_at(x1, y0, panel.plan.number)
        assert abs(right - panel.left - panel.width) <= 1
        assert abs(bottom - panel.top - panel.height) <= 1


@settings(max_examples=examples(40), deadline=None)
@given(st.lists(st.tuples(st.floats(0, 30), st.floats(0, 20)), min_size=1, max_size=12))
@example([(0.0, 0.0)] * 12)
@example([(30.0, 20.0)] * 12)
def test_discs_do_not_cover_one_another(points):
    labels = LabelPlacer(sheet := make_sheet(rectangular_floor_plans(30.0, 20.0, 1)))
    half = 11.0 * FINER
    placed = [labels.reserve_nearest(sheet.pixel_at(x, y, 1), half, half, 1) for x, y in points]
    assert placed[0] == sheet.pixel_at(*points[0], 1)
    for k, (x, y) in enumerate(placed):
        assert all(max(abs(x - a), abs(y - b)) >= 2 * half for a, b in placed[k + 1 :])


def test_plans_show_the_site(navigator):
    plans = floor_plans(navigator.site)
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


def test_upper_floors_have_one_frame(navigator):
    site = navigator.site
    # The upper three floors get less on them, as all of them are equally wide.
    height = site.spec.floors[3].z - 0.5
    places = [(e, e.solids[0].center) for e in site.elements]
    less = tuple(e for e, (x, _, z) in places if z < height or 3.0 < x < 11.0)
    plans = floor_plans(site.replacing_elements(less))
    assert len({plan.bounds for plan in plans[1:]}) == 1
    lowest, upper = plans[0].bounds, plans[1].bounds
    # The ground floor is larger, and extends beyond all that is above it.
    assert all(a < b for a, b in zip(lowest[:2], upper[:2], strict=True))
    assert all(a > b for a, b in zip(lowest[2:], upper[2:], strict=True))
    for plan in plans[1:]:
        points = [p for role, shapes in plan.shapes for shape in shapes for p in shape]
        assert all(upper[0] <= x <= upper[2] and upper[1] <= y <= upper[3] for x, y in points)


def test_states_look_different():
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 2))
    pictures = {
        state: near(draw(sheet, markers=[Marker(5.0, 5.0, 2, "7", state)]), sheet, 5, 5, 2)
        for state in STYLES
    }
    for state, part in pictures.items():
        assert has(part, STYLES[state].fill)
        assert all(differs(part, other) for name, other in pictures.items() if name != state)
    chosen = draw(sheet, markers=[Marker(5.0, 5.0, 2, "7", "open", chosen=True)])
    assert has(near(chosen, sheet, 5, 5, 2, 18), ROBOT)
    other = draw(sheet, markers=[Marker(5.0, 5.0, 2, "8", "open")])
    assert differs(near(other, sheet, 5, 5, 2), pictures["open"])


def test_the_legend_has_what_is_in_the_picture(navigator):
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 2))
    meanings = {"open": "to be read", "done": "read"}
    one = Marker(5.0, 5.0, 2, "7", "open")
    way = [PathPoint(0.0, 15.0, 15.0, 1), PathPoint(10.0, 20.0, 15.0, 1)]
    plain = legend_of(draw(sheet, legend=meanings))
    assert not any(has(plain, STYLES[state].fill) for state in meanings)
    parts = {
        "a checkpoint": {"markers": [one]},
        "another state": {"markers": [one, Marker(9.0, 5.0, 2, "8", "done")]},
        "the one chosen last": {"markers": [replace(one, chosen=True)]},
        "a footprint": {"footprint": navigator.robot.footprint},
        "a way": {"path": [*way, PathPoint(20.0, 20.0, 5.0, 1)]},
        "a way over stairs": {"path": [*way, PathPoint(20.0, 20.0, 15.0, 2)]},
    }
    drawn = {name: legend_of(draw(sheet, legend=meanings, **part)) for name, part in parts.items()}
    for name, part in drawn.items():
        assert differs(part, plain)
        assert all(differs(part, other) for also, other in drawn.items() if also != name)
    assert has(drawn["another state"], STYLES["done"].fill)
    assert not has(drawn["a checkpoint"], STYLES["done"].fill)


def test_no_line_crosses_a_disc():
    """Lines that join shifted discs to their positions lie below all discs."""
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 1))
    crowd = [Marker(15.0, 10.0, 1, "", "open") for _ in range(12)]
    picture = draw(sheet, markers=crowd, path=[PathPoint(0.0, 1.0, 1.0, 1)])
    labels = LabelPlacer(sheet)
    labels.occupy(sheet.pixel_at(1.0, 1.0, 1), POINT * FINER, POINT * FINER)
    half = (crowd[0].radius + 1.0) * FINER
    for marker in crowd:
        x, y = labels.reserve_nearest(sheet.pixel_at(marker.x, marker.y, 1), half, half, 1)
        column, row = round(x / FINER), round(y / FINER)
        disc = picture[row - 5 : row + 6, column - 5 : column + 6]
        assert not has(disc, STYLES["open"].rim)


def test_the_footprint_is_drawn_to_scale():
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 1))
    way = [PathPoint(0.0, 15.0, 10.0, 1)]
    robot = Footprint(front=1.0, rear=2.0, half_width=0.5)
    picture = draw(sheet, footprint=robot, path=way)
    rows, columns = np.nonzero((picture[HEAD:-FOOT] == ROBOT).all(axis=-1))
    x, y = (v / FINER for v in sheet.pixel_at(15.0, 10.0, 1))
    scale = sheet.scale / FINER
    assert columns.max() - x == pytest.approx(1.0 * scale, abs=2.0)
    assert x - columns.min() == pytest.approx(2.0 * scale, abs=2.0)
    assert rows.max() + HEAD - y == pytest.approx(0.5 * scale, abs=2.0)


def test_the_name_of_a_dock_is_not_covered(navigator):
    """The robot, the path and the checkpoints leave it whole."""
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 1))
    dock = StationMark(15.0, 10.0, 1, "dock")
    crowd = [Marker(15.0 + dx, 10.0 + dy, 1, "9", "open") for dx in (-1, 1, 2) for dy in (-1, 0, 1)]
    way = [
        PathPoint(0.0, 15.0, 10.0, 1),
        PathPoint(5.0, 25.0, 10.0, 1),
        PathPoint(10.0, 15.0, 10.0, 1),
    ]
    alone = draw(sheet, stations=[dock], headline="")
    full = draw(
        sheet,
        stations=[dock],
        headline="",
        markers=crowd,
        path=way,
        heading=1.0,
        footprint=navigator.robot.footprint,
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


def test_the_path_is_drawn_between_floors():
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 2))
    climb = [
        PathPoint(0.0, 20.0, 10.0, 1),
        PathPoint(50.0, 5.0, 10.0, 1),
        PathPoint(60.0, 5.0, 4.0, 2),
        PathPoint(90.0, 25.0, 4.0, 2),
    ]
    drawn = path_lines(sheet, climb)
    assert len(drawn) == 2  # no line from floor to floor
    for line, number in zip(drawn, (1, 2), strict=True):
        panel = sheet.panels[number]
        assert (line.points[:, 0] >= panel.left).all()
        assert (line.points[:, 0] <= panel.left + panel.width).all()
        assert all(a <= b for a, b in pairwise(line.shades))
    # There is a mark at the lower end and one at the upper end: around each, more pixels have the
    # colour of its time than in a picture with the line alone.
    picture, bare = draw(sheet, path=climb), sheet.image.copy()
    draw_lines_with_arrows(ImageDraw.Draw(bare), drawn)
    bare = np.asarray(bare.reduce(FINER))
    for moment in climb[1:3]:
        ink = ImageColor.getrgb(colour(moment.t / 90.0))
        there, without = (
            (near(p, sheet, moment.x, moment.y, moment.floor, 45) == ink).all(axis=-1).sum()
            for p in (picture, bare)
        )
        assert there > without + 100


@pytest.fixture(scope="module")
def inspect():
    env = InspectEnv(faults=0, render_mode="rgb_array")
    yield env
    env.close()


@pytest.mark.long
def test_a_picture_shows_the_state_of_an_inspection(inspect, navigator):
    inspect.reset(seed=2, options={})
    before = inspect.render()
    assert before.shape == SHAPE
    assert before.dtype == np.uint8
    sheet = make_sheet(floor_plans(navigator.site))
    c = navigator.site.checkpoints[5]
    place = (c.position[0], c.position[1], c.floor)
    assert has(near(before, sheet, *place), STYLES["open"].fill)
    inspect.step(5)
    after = inspect.render()
    assert not differs(after, inspect.render())
    assert has(near(after, sheet, *place, 24), STYLES["done"].fill)
    # If another checkpoint counts as the one chosen last, only the ring and its entry in the
    # legend change.
    inspect._actions[-1] = 20
    part, other = (near(p, sheet, *place, 24) for p in (after, inspect.render()))
    ring = (part == ROBOT).all(axis=-1) & (part != other).any(axis=-1)
    assert ring.sum() > 50


def test_an_inspection_shows_the_chosen_floors(inspect, navigator):
    pictures = []
    for options, count in (({}, 6), ({"floor": 1}, 1), ({"floor": [1, 2]}, 2), ({"floor": 2}, 2)):
        inspect.reset(seed=2, options=options)
        pictures.append(inspect.render())
        # Each floor that is shown has its frame; fewer floors are drawn larger.
        sheet = make_sheet(floor_plans(navigator.site)[:count])
        for panel in sheet.panels.values():
            for row in (panel.top, panel.top + panel.height):
                line = pictures[-1][row // FINER, panel.left // FINER + 2 :][: panel.width // 4]
                assert (line == line[0]).all()
                assert line[0].max() < 240
    assert all(differs(a, b) for a, b in pairwise(pictures))
    inspect.reset(seed=2, options={})


def test_the_trail_of_an_inspection_is_the_driven_path(inspect, navigator):
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
        digests = []
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
            digests.append(rollouts.digest(rollouts.rollout(env, 4, 6)))
            env.close()
        assert digests[0] == digests[1]


@pytest.mark.parametrize("scenario", ["random", "umad"])
def test_a_picture_shows_the_state_of_a_route(scenario):
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
    sheet = make_sheet(rectangular_floor_plans(30.0, 20.0, 3))
    x, y, _ = next(p for p in env.instance.positions[1:-1].tolist() if p[2] == 2)
    part = near(env.render(), sheet, x, y, 2)
    assert has(part, STYLES["outside"].rim)
    assert not has(part, STYLES["open"].fill)


class ThreeInALine:
    """Custom source of instances, about whose site nothing is known."""

    checkpoints, floors = 3, 2

    def draw(self, *_):
        places = np.array([[0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 0, 2], [0, 0, 1]], dtype=float)
        times = np.abs(np.subtract.outer(places[:, 0], places[:4, 0])) + 1.0
        prizes = np.array([0.0, 0.5, 0.5, 0.5])
        return make_instance(times, np.zeros(4), prizes, [], 100.0, places)


def test_routes_of_custom_sources_are_drawn():
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


def test_a_batch_counts_visited_checkpoints():
    """It does so for a route that has ended as well, where the robot is in the dock."""
    batch = RouteVectorEnv(1, checkpoints=5, render_mode="rgb_array")
    single = RouteEnv(checkpoints=5, render_mode="rgb_array")
    observation, _ = batch.reset(seed=1)
    single.reset(seed=1)
    for node in (int(np.flatnonzero(observation["mask"][0])[-1]), 0):
        batch.step(np.array([node]))
        single.step(node)
    assert not differs(batch.render()[0][:HEAD], single.render()[:HEAD])


@pytest.mark.physics
def test_a_drive_is_drawn_with_its_goal(yard_file):
    env = DriveEnv(yard_file, render_mode="rgb_array")
    env.reset(seed=1)
    state, pose = env.get_state(), env.pose
    # The camera behind the robot looks ahead.
    goals = [
        (pose.x + far * np.cos(pose.yaw), pose.y + far * np.sin(pose.yaw), pose.z)
        for far in (1.5, -30.0)
    ]
    ahead, behind = (
        (env.set_state(state | {"goal": goal}), env.render())[1][:-38] for goal in goals
    )
    assert ahead.shape == (322, 640, 3)
    assert (ahead == GOAL).all(axis=-1).sum() > 50
    assert not (behind == GOAL).all(axis=-1).any()
    # Nothing else differs.
    assert np.ptp(np.nonzero((ahead != behind).any(axis=-1))[1]) < 100
    env.set_state(state)
    first = env.render()
    env.step(np.zeros(3))
    assert differs(first[-38:], env.render()[-38:])  # the caption changes
    env.close()


def test_a_window_shows_the_state_after_the_step(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")  # windows are drawn in memory
    env = RouteEnv(checkpoints=5, render_mode="human")
    shown = []
    monkeypatch.setattr("argo_env.envs.episode.FigureWindow.show", lambda _, p: shown.append(p))
    env.reset(seed=0)
    env.step(int(np.flatnonzero(env.action_masks())[-1]))
    env.render_mode = "rgb_array"
    assert not differs(shown[-1], env.render())
    assert differs(*shown)
    env.close()
