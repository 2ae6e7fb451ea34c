import io
import math
import os
import signal
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.stages import listen_to_stages
from argo_compiler.il import Action, Mission, Task
from argo_env.files import cache
from argo_env.pictures import check_film, film, overview, write_film, write_overview
from argo_env.pictures.camera import Camera
from argo_env.pictures.chase import ChaseCamera
from argo_env.pictures.light import shadow_mask, sun_camera
from argo_env.pictures.motion import RecordedMotion
from argo_env.pictures.overview import add_robot, site_camera, view_without_robot
from argo_env.pictures.scene import Scene
from argo_env.pictures.site_plan import draw_site_plan
from argo_env.planning.flaws.flaw import Flaw, Mark
from argo_env.robot.pose import BodyPose
from argo_env.run.record import PathSample, Reading, Result
from argo_env.site import load_site
from argo_env.site.storeys import storeys
from tests.yard import record_of

DURATION = 20.0


@pytest.fixture(scope="module")
def record(umad):
    """A record of 20 s along the south side of the slab, with a reading after 12 s."""
    mission = Mission(site="umad", tasks=(Task(name="START", action=Action.START),))
    path = tuple(
        PathSample(t=t, x=3.0 + 0.4 * t, y=-2.0, z=-0.03, yaw=0.0, pitch=0.0, floor=1)
        for t in np.arange(0.0, DURATION + 0.1, 0.5).tolist()
    )
    gauge = umad.checkpoint(1)
    reading = Reading(
        checkpoint=1, name=gauge.name, kind=gauge.kind, floor=1, task="MEASURE 1", t=12.0,
        value=9.0, unit=gauge.unit, nominal=gauge.nominal, normal=False, distance=1.0,
    )  # fmt: skip
    result = Result(
        success=True, verdict="done", duration=DURATION, max_duration=None,
        within_max_duration=True, docked=None, distance=8.0, climbed=0.0,
    )  # fmt: skip
    return record_of(mission, result=result, readings=(reading,), path=path)


@pytest.fixture(scope="module")
def scene(umad, robot):
    with Scene(umad, robot) as scene:
        yield scene


@pytest.mark.parametrize("name", ["film.avi", "film"])
def test_a_film_is_an_mp4_or_a_gif(tmp_path, name):
    with pytest.raises(ArgoError, match=r"\.mp4 or a \.gif"):
        check_film(tmp_path / name)


@pytest.mark.physics
def test_a_film_needs_an_existing_folder_and_a_name_that_is_no_folder(tmp_path):
    with pytest.raises(ArgoError, match=r"folder .* does not exist"):
        check_film(tmp_path / "none" / "film.gif")
    (tmp_path / "folder.gif").mkdir()
    with pytest.raises(ArgoError, match="is a folder"):
        check_film(tmp_path / "folder.gif")


@pytest.mark.physics
def test_without_the_extra_an_mp4_is_refused_and_a_gif_is_not(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ArgoError, match=r"needs imageio-ffmpeg: pip install .*\[film\].*, or name"):
        check_film(tmp_path / "film.mp4")
    check_film(tmp_path / "film.gif")


def test_every_element_is_in_a_storey(umad):
    drawn = {e.name for elements in storeys(umad).values() for e in elements}
    assert drawn == {e.name for e in umad.elements}


@pytest.mark.physics
def test_floors_above_are_hidden(scene):
    # The camera looks straight down on the south aisle of floor 2, which is above the slab.
    camera = Camera((6.0, 1.5, 30.0), (6.0, 1.6, 0.0), (60, 60), 3.0)
    heights = {}
    for top in (6, 2, 1):
        scene.show_floors(top)
        heights[top] = 30.0 - np.median(scene.render_from(camera).depth)
    assert heights == pytest.approx({6: 12.5, 2: 2.5, 1: 0.0}, abs=0.1)


@pytest.mark.physics
def test_projection_inverts_unprojection(scene):
    scene.show_floors(6)
    camera = Camera((-16.0, -22.0, 17.0), (8.0, 5.0, 6.0), (200, 150), 40.0, near=5.0)
    view = scene.render_from(camera)
    row, column = np.indices((150, 200)).reshape(2, -1)
    depth = np.where(np.isfinite(view.depth), view.depth, 50.0)[row, column]
    pixels = camera.project_with_depth(camera.unproject(column, row, depth)).reshape(150, 200, 3)
    assert pixels[40, 70, :2] == pytest.approx([70.5, 40.5])
    assert pixels[120, 30, :2] == pytest.approx([30.5, 120.5])


@pytest.mark.physics
def test_the_robot_is_in_the_middle_of_the_frame(scene, robot):
    pose = BodyPose(8.0, -2.0, -0.03, 0.0)
    chase = ChaseCamera(scene, (120, 80), 0.1)
    scene.show_floors(1, 2)
    scene.hide_robot()
    camera = chase.next_camera(pose)
    without = scene.render_from(camera).colours
    scene.place_robot(pose, robot.arm_stowed)
    changed = np.abs(scene.render_from(camera).colours.astype(int) - without).sum(axis=2) > 30
    rows, columns = np.nonzero(changed)
    assert changed[40, 60]
    assert columns.mean() == pytest.approx(60, abs=8)
    assert rows.mean() == pytest.approx(40, abs=8)


def test_the_arm_is_raised_while_measuring(record, robot):
    motion = RecordedMotion(record, robot)
    raised, stowed = robot.arm_raised["arm_elbow"], robot.arm_stowed["arm_elbow"]
    angles = [motion.joint_degrees_at(t)["arm_elbow"] for t in (3.9, 8.0, 12.1)]
    assert angles == pytest.approx([stowed, raised, stowed])
    assert motion.pose_at(0.25).x == pytest.approx(3.1)


def test_flippers_lie_flat_on_stairs(record, robot):
    tilted = record.model_copy(
        update={"path": tuple(s.model_copy(update={"pitch": -0.5}) for s in record.path)}
    )
    flat, stairs = (
        RecordedMotion(r, robot).joint_degrees_at(1.0)["left_flipper_joint"]
        for r in (record, tilted)
    )
    assert (flat, stairs) == (pytest.approx(30.0), 0.0)


@pytest.mark.physics
def test_the_overview_shows_the_path_in_its_colours(record, umad, robot, tmp_path, monkeypatch):
    monkeypatch.setattr(overview, "SIZE", (800, 600))
    monkeypatch.setattr(overview, "_SHADOW_MAP", 400)
    monkeypatch.setattr(overview, "_FINER", 1)
    write_overview(record, umad, robot, tmp_path / "site.png")
    with Image.open(tmp_path / "site.png") as image:
        assert (image.format, image.size) == ("PNG", (800, 600))
        pixels = np.asarray(image.convert("RGB")).astype(int)
    camera = overview.site_camera(umad, (800, 600))
    for t in (5.0, 10.0, 16.0):
        column, row, _ = camera.project_with_depth(np.array([[3.0 + 0.4 * t, -2.0, -0.03 + 0.25]]))[
            0
        ]
        red, green, blue = pixels[int(row), int(column)]
        wanted = overview.colour(t / DURATION)
        given = [int(wanted[k : k + 2], 16) for k in (1, 3, 5)]
        assert [red, green, blue] == pytest.approx(given, abs=24)


@pytest.mark.physics
def test_a_gif_has_a_frame_for_each_time(record, umad, robot, tmp_path):
    for name in ("a.gif", "b.gif"):
        write_film(record, umad, robot, tmp_path / name, speed=10, fps=4, size=(120, 80))
    with Image.open(tmp_path / "a.gif") as image:
        assert (image.format, image.size) == ("GIF", (120, 80))
        # 20 s, 10 times as fast, with 4 frames per second, and the last frame for 2 s.
        assert image.n_frames == 8 + 8
        assert image.info["duration"] == 250
        image.seek(8)
        image.load()
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.gif", "b.gif"]


@pytest.mark.long
def test_several_processes_draw_the_same_film(record, umad, robot, tmp_path, monkeypatch):
    monkeypatch.setattr(film, "usable_processors", lambda: 2)
    for name, worth_it in (("alone.gif", 10**6), ("together.gif", 2)):
        monkeypatch.setattr(film, "_MIN_PARALLEL_SHOTS", worth_it)
        write_film(record, umad, robot, tmp_path / name, speed=10, fps=4, size=(120, 80))
    assert (tmp_path / "alone.gif").read_bytes() == (tmp_path / "together.gif").read_bytes()


@pytest.mark.long
def test_a_killed_process_is_reported(record, umad, robot, tmp_path, monkeypatch):
    monkeypatch.setattr(film, "usable_processors", lambda: 2)
    monkeypatch.setattr(film, "_MIN_PARALLEL_SHOTS", 2)
    monkeypatch.setattr(film, "_draw_shot", killed)
    with pytest.raises(ArgoError, match="a process that drew the frames was killed"):
        write_film(record, umad, robot, tmp_path / "film.gif", speed=10, fps=4, size=(120, 80))
    assert list(tmp_path.iterdir()) == []


def killed(_):
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.long
def test_the_last_frames_show_the_verdict(record, umad, robot, tmp_path):
    failed = record.result.model_copy(
        update={"success": False, "verdict": "the robot is not docked; " + "failed: a task, " * 99}
    )
    films = []
    for name, made in (("a.gif", record), ("b.gif", record.model_copy(update={"result": failed}))):
        write_film(made, umad, robot, tmp_path / name, speed=10, fps=4, size=(240, 160))
        with Image.open(tmp_path / name) as image:
            shown = []
            for k in (7, 8, 15):
                image.seek(k)
                shown.append(np.asarray(image.convert("RGB")).astype(int))
            films.append(shown)
    assert all((ended == last).all() for _, ended, last in films), "the film has stopped"
    for k, verdict in enumerate((False, True, True)):
        differs = (np.abs(films[0][k] - films[1][k]).sum(axis=2) > 90).mean(axis=1)
        # The verdict is between the picture above it and the caption below.
        assert (differs[90:140].max() > 0.05) == verdict
        assert differs[:60].max() < 0.05
        assert differs[145:].max() < 0.05


@pytest.mark.physics
def test_an_mp4_has_a_frame_for_each_time(record, umad, robot, tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    file = tmp_path / "film.mp4"
    write_film(record, umad, robot, file, speed=10, fps=4, size=(120, 80))
    content = file.read_bytes()
    assert content[4:8] == b"ftyp"
    assert b"avc1" in content
    assert content.index(b"moov") < content.index(b"mdat")  # plays while it loads
    assert imageio_ffmpeg.count_frames_and_secs(str(file))[0] == 8 + 8


@pytest.mark.physics
@pytest.mark.parametrize("wrong", [{"speed": 0.0}, {"speed": math.nan}, {"size": (121, 80)}])
def test_invalid_numbers_for_a_film_are_refused(record, umad, robot, tmp_path, wrong):
    with pytest.raises(ArgoError, match="a film needs"):
        write_film(record, umad, robot, tmp_path / "film.gif", **wrong)


@pytest.mark.physics
def test_a_film_tells_its_progress_from_the_first_picture_on(record, umad, robot, tmp_path):
    told = []
    with listen_to_stages(lambda stage, share, _: told.append((stage, share))):
        write_film(record, umad, robot, tmp_path / "film.gif", speed=10, fps=2, size=(64, 64))
    for name in ("placing the film's camera", "drawing the film"):
        shares = [share for stage, share in told if stage == name and share is not None]
        assert len(set(shares)) > 2
        assert shares == sorted(shares)
        assert shares[-1] == 1.0


@pytest.mark.physics
def test_a_record_of_another_site_is_refused(record, umad, robot, tmp_path):
    other = record.model_copy(update={"site": "elsewhere"})
    with pytest.raises(ArgoError, match="elsewhere"):
        write_film(other, umad, robot, tmp_path / "film.gif")
    with pytest.raises(ArgoError, match="elsewhere"):
        write_overview(other, umad, robot, tmp_path / "site.png")


@pytest.mark.parametrize("words", [1, 100])
def test_a_mark_far_outside_is_drawn_at_the_edge(words):
    site = load_site("darmstadt")
    flaw = Flaw("wrong " * words, (Mark(1, -500.0, 900.0),))
    drawn = Image.open(io.BytesIO(draw_site_plan(site, [flaw])))
    plain = Image.open(io.BytesIO(draw_site_plan(site)))
    assert plain.size == (1280, 720)
    assert drawn.height == 720 + 17 * (2 if words == 1 else 4 + 1)
    corner = (0, 60, 60, 300)  # the north-west of floor 1
    assert drawn.crop(corner).tobytes() != plain.crop(corner).tobytes()


SIZE, MAP = (480, 360), 320


@pytest.fixture(scope="module")
def whole(umad, robot):
    with Scene(umad, robot) as scene:
        yield scene


@pytest.fixture(scope="module")
def alone(robot):
    with Scene(None, robot) as scene:
        yield scene


@pytest.mark.long
@settings(max_examples=15)
@given(
    st.floats(-3.0, 18.0), st.floats(-4.0, 12.0), st.sampled_from([-0.03, 2.5, 5.0, 12.5]),
    st.floats(-3.0, 3.0),
)  # fmt: skip
def test_a_composed_view_is_equal_to_a_rendered_one(umad, robot, whole, alone, x, y, z, yaw):
    camera, sun = site_camera(umad, SIZE), sun_camera(umad, MAP)
    site_only = view_without_robot(umad, robot, camera, sun)
    for scene in (whole, alone):
        scene.place_robot(BodyPose(x, y, z, yaw), robot.arm_raised)
    composed = add_robot(site_only, alone, camera, sun)
    seen, lit = whole.render_from(camera), whole.render_from(sun)
    # Where two surfaces are equally near, either may be visible.
    assert (composed.view.colours != seen.colours).any(axis=2).mean() < 1e-3
    finite = np.isfinite(seen.depth)
    assert (np.isfinite(composed.view.depth) == finite).all()
    assert composed.view.depth[finite] == pytest.approx(seen.depth[finite], abs=1e-3)
    dark = shadow_mask(camera, seen.depth, sun, lit.depth)
    assert (composed.dark != dark).mean() < 1e-4


@pytest.mark.physics
def test_the_view_of_a_site_is_rendered_once(umad, robot, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    camera, sun = site_camera(umad, (80, 60)), sun_camera(umad, 50)
    first = view_without_robot(umad, robot, camera, sun)
    monkeypatch.setattr("argo_env.pictures.overview.Scene", None)  # no further scene can be made
    again = view_without_robot(umad, robot, camera, sun)
    assert (again.view.colours == first.view.colours).all()
    assert (again.view.depth == first.view.depth).all()
    assert (again.dark == first.dark).all()


@pytest.mark.physics
def test_another_site_or_camera_has_another_view(umad, robot, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    camera, sun = site_camera(umad, (80, 60)), sun_camera(umad, 50)
    first = view_without_robot(umad, robot, camera, sun)
    fewer = umad.replacing_elements(umad.elements[: len(umad.elements) // 2])
    assert (view_without_robot(fewer, robot, camera, sun).view.colours != first.view.colours).any()
    assert view_without_robot(umad, robot, site_camera(umad, (60, 80)), sun).view.depth.shape == (
        80,
        60,
    )
