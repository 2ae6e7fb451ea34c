"""Import of missions from bytes: kinds of uploads, and errors."""

import math

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError, Invalid, Remedy, Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.mission_file import mission_text
from argo_compiler.hfsm import lower
from argo_compiler.isar import to_isar
from argo_compiler.ros import Storage, to_ros1_bag, to_ros2_bag
from argo_env.planning.inspection_views import inspection_views_by_object_id
from argo_env.planning.site_warnings import not_seen_from_pose_warnings, with_seeing_poses
from argo_planner.use_cases.checking import check_source
from argo_planner.use_cases.importing import (
    SourceKind,
    Upload,
    guess_source_kind,
    import_mission,
    load_unchecked_mission,
)
from tests.yard import measure, mission

SCRIPT = b"""Mission Protocol: one
1. Set the starting point in starting area 1.
2. Check checkpoint #1.
3. Check checkpoint #2.
"""
PLAN = mission(measure(1), measure(2), start_area=1, end_area=1)


@pytest.fixture(scope="module")
def uploads(site):
    views = inspection_views_by_object_id(PLAN, site.navigator)
    return {
        SourceKind.SCRIPT: [
            Upload("plan.txt", SCRIPT),
            Upload("no suffix", SCRIPT),
            Upload("plan.txt", SCRIPT.decode().encode("utf-16")),
        ],
        SourceKind.MISSION: [
            Upload(name, mission_text(PLAN).encode(encoding))
            for name in ("plan.json", "/dev/stdin")
            for encoding in ("utf-8", "utf-8-sig", "utf-16", "utf-16-be")
        ],
        SourceKind.ISAR: [
            Upload("plan.json", to_isar(PLAN, lower(PLAN), views).encode(encoding))
            for encoding in ("utf-8", "utf-16")
        ],
        SourceKind.BAG: [
            Upload("plan.bag", to_ros1_bag(PLAN)),
            Upload("named as no bag is", to_ros1_bag(PLAN)),
            *(Upload("folder", to_ros2_bag(PLAN, storage)) for storage in Storage),
            *(
                Upload(f"one file of a {storage}", content)
                for storage in Storage
                for name, content in to_ros2_bag(PLAN, storage).items()
                if name != "metadata.yaml"
            ),
        ],
    }


@pytest.mark.parametrize("kind", SourceKind)
def test_uploads_are_recognized_and_imported(uploads, site, kind):
    for upload in uploads[kind]:
        assert guess_source_kind(upload) is kind
        imported = import_mission(upload, site)
        measured = [task.object_id for task in imported.mission.tasks if task.object_id]
        assert measured == ["1", "2"]
        assert imported.source_name == upload.name
        if kind in {SourceKind.MISSION, SourceKind.BAG}:
            assert imported.mission == PLAN


def test_a_bag_may_lie_on_this_machine(site, tmp_path):
    path = tmp_path / "plan.bag"
    path.write_bytes(to_ros1_bag(PLAN))
    assert import_mission(Upload("mine", path), site).mission == PLAN


@pytest.mark.parametrize(
    ("upload", "code", "says"),
    [
        (Upload("a.txt", b""), "invalid", "a.txt is empty"),
        (Upload("a.txt", b"Mission\0"), "invalid", "a.txt is a binary file, not text"),
        (Upload("a.txt", "Öl".encode("cp1252")), "invalid", "a.txt is not UTF-8"),
        (Upload("a.txt", b"Dear robot"), "invalid", "script.nothing-to-do"),
        (Upload("a.json", b"{"), "invalid", "a.json:1:2: error"),
        (Upload("a.json", b" \n"), "invalid", "a.json: error: the file is empty"),
        (Upload("a.json", b"\xff"), "invalid", "file.not-text"),
        (Upload("a.bag", b"#ROSBAG V2.0\n"), "invalid", "ros.broken-bag"),
        (Upload("a.mcap", b"no"), "invalid", "ros.not-a-bag"),
        (Upload("folder", {}), "invalid", "choose the script, mission or bag in it"),
        (Upload("folder", {"../metadata.yaml": b""}), "invalid", "not a valid file name"),
        (Upload("a.json", b'{"tasks": [{"name": "A", "action": "MEASURE", "object_id": "9"}]}'),
         "invalid", "il.unknown-object"),
    ],
)  # fmt: skip
def test_errors_name_the_upload(site, upload, code, says):
    with pytest.raises(ArgoError) as caught:
        import_mission(upload, site)
    assert caught.value.code == code
    assert says in str(caught.value)
    assert upload.name in str(caught.value)


def test_no_option_is_named(site):
    """A service has no options; the command line finds them by the remedies."""
    mission_file = Upload("plan.json", mission_text(PLAN).encode())
    with pytest.raises(Invalid, match="has its areas already") as caught:
        load_unchecked_mission(mission_file, site.catalog, start_area=1)
    assert caught.value.remedies == (Remedy.CHOOSE_AREAS,)
    assert "--" not in str(caught.value)
    open_start = Upload("a.txt", b"Mission Protocol: one\n1. Check checkpoint #1.\n")
    with pytest.raises(DiagnosticError) as refused:
        import_mission(open_start, site)
    assert "--" not in str(refused.value)
    assert [d.remedies for d in refused.value.diagnostics] == [(Remedy.CHOOSE_START,)]
    assert import_mission(open_start, site, start_area=1).mission.start_area == 1


@pytest.mark.parametrize(("speed", "codes"), [("5", ["site.faster-than-robot"]), ("0.2", [])])
def test_a_speed_beyond_the_robots_own_is_warned_of(speed, codes, site):
    script = SCRIPT.replace(b"checkpoint #2", f"checkpoint #2 at {speed} m/s".encode())
    found = import_mission(Upload("plan.txt", script), site).warnings
    assert [(d.code, d.span.line) for d in found] == [(code, 4) for code in codes]


def test_a_checkpoint_of_isar_is_read_from_the_nearest_pose_that_sees_it(site):
    hidden = Pose(x=5.55, y=1.55, z=0.02)
    planned = mission(measure(1, pose=hidden), measure(2), start_area=1, end_area=1)
    views = inspection_views_by_object_id(planned, site.navigator)
    upload = Upload("plan.json", to_isar(planned, lower(planned), views).encode())
    imported = import_mission(upload, site)
    (warning,) = [d for d in imported.warnings if d.code == "isar.pose-moved"]
    assert "not from the given one: " in warning.message
    first, second = (t for t in imported.mission.tasks if t.object_id)
    assert f"x {first.pose.x:.2f}, y {first.pose.y:.2f}" in warning.message
    assert (first.pose.x, first.pose.y) != (hidden.x, hidden.y)
    assert second.pose.x == pytest.approx(views["2"].pose.x)
    assert list(not_seen_from_pose_warnings(imported.mission, site)) == []
    codes = [diagnostic.code for diagnostic in check_source(upload, site.catalog, site=site)]
    assert codes.count("isar.pose-moved") == 1
    assert "site.not-seen-from-pose" not in codes


@pytest.mark.parametrize(
    ("x", "y"), [(5.55, 1.55), (5.0, 3.0), (2.05, 0.55), (100.0, 100.0), (-3.0, 0.0)]
)
def test_no_pose_that_sees_a_checkpoint_of_isar_is_nearer_than_the_offered_one(site, x, y):
    given = Pose(x=x, y=y, z=0.02)
    plan, warnings = with_seeing_poses(mission(measure(1, pose=given)), site)
    assert [warning.code for warning in warnings] == ["isar.pose-moved"]
    (offered,) = [task.pose for task in plan.tasks if task.object_id]
    nearer = math.hypot(offered.x - x, offered.y - y) - 0.1
    rng = np.random.default_rng(1)
    for _ in range(200):
        beside = Pose(x=offered.x + rng.uniform(-1, 1), y=offered.y + rng.uniform(-1, 1), z=0.02)
        try:
            stands = site.navigator.snap_keeping_heading(beside)
        except Unreachable:
            continue
        if math.hypot(stands.x - x, stands.y - y) < nearer:
            pose = stands.model_copy(update={"yaw": rng.uniform(-math.pi, math.pi)})
            assert list(not_seen_from_pose_warnings(mission(measure(1, pose=pose)), site))


def test_a_pose_of_isar_that_sees_its_checkpoint_stays(site):
    views = inspection_views_by_object_id(PLAN, site.navigator)
    upload = Upload("plan.json", to_isar(PLAN, lower(PLAN), views).encode())
    imported = import_mission(upload, site)
    assert not [d for d in imported.diagnostics if d.code == "isar.pose-moved"]
    (task,) = (t for t in imported.mission.tasks if t.object_id == "1")
    assert task.pose.x == pytest.approx(views["1"].pose.x)
