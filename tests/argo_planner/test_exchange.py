"""Import of missions from bags and isar, and export to isar."""

import json

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.files.mission_file import mission_text
from argo_compiler.hfsm import lower
from argo_compiler.il import Mission
from argo_compiler.isar import InspectionView, to_isar
from argo_compiler.ros import Storage, to_ros1_bag, to_ros2_bag
from argo_planner.terminal.files import read_upload
from argo_planner.use_cases.exporting import export_mission
from argo_planner.use_cases.importing import (
    ImportedMission,
    SourceKind,
    guess_source_kind,
    load_unchecked_mission,
)
from tests.argo_compiler.script.conftest import CATALOG
from tests.mission_writing import measure

TASKS = measure("A", "B", object_id="1"), measure("B", object_id="4")
PLAN = Mission(designation="Round", tasks=TASKS)
VIEWS = {id: InspectionView(pose=Pose(x=1, y=2, z=0), target=(0, 2, 1)) for id in ("1", "4")}


def load(path):
    return load_unchecked_mission(read_upload(path), CATALOG)


@pytest.fixture
def sources(tmp_path):
    own, bag, isar = (tmp_path / name for name in ("plan.json", "plan.bag", "isar.json"))
    own.write_text(mission_text(PLAN), encoding="utf-8")
    bag.write_bytes(to_ros1_bag(PLAN))
    isar.write_text(to_isar(PLAN, lower(PLAN), VIEWS), encoding="utf-8")
    folders = []
    for storage in Storage:
        folders.append(tmp_path / storage)
        folders[-1].mkdir()
        for name, content in to_ros2_bag(PLAN, storage).items():
            (folders[-1] / name).write_bytes(content)
    return own, bag, isar, *folders


def test_each_form_of_a_mission_is_read(sources):
    own, _, isar, *_ = sources
    for source in sources:
        kind = guess_source_kind(read_upload(source))
        assert kind is not SourceKind.SCRIPT
        assert (kind is SourceKind.MISSION) == (source == own)
        if source != isar:
            assert load(source).mission == PLAN
    imported = load(isar).mission
    assert [(t.name, t.object_id, t.transitions) for t in imported.tasks] == [
        (t.name, t.object_id, t.transitions) for t in PLAN.tasks
    ]


def test_findings_about_them_are_shown_without_a_place(sources):
    lost = PLAN.tasks[1].model_copy(update={"object_id": "99"})
    findings = check(PLAN.model_copy(update={"tasks": (PLAN.tasks[0], lost)}), CATALOG)
    assert findings
    for source in sources[1:]:
        placed = load(source).diagnostics_with_positions(findings)
        assert [(f.code, f.span) for f in placed] == [(f.code, None) for f in findings]


def test_areas_are_not_chosen_for_them(sources):
    for source in sources:
        with pytest.raises(ArgoError, match="has its areas already"):
            load_unchecked_mission(read_upload(source), CATALOG, 1)


def test_warnings_of_the_import_are_returned(tmp_path):
    data = json.loads(to_isar(PLAN, lower(PLAN), VIEWS))
    data["tasks"][1]["zoom"] = {"objectWidth": 1, "objectHeight": 1}
    path = tmp_path / "isar.json"
    path.write_text(json.dumps(data))
    (finding,) = load(path).diagnostics
    assert finding.message.startswith("tasks[1].zoom is ignored")


def test_isar_gets_the_positions_of_the_checkpoints(umad, navigator):
    content = export_mission(ImportedMission(PLAN, "plan.json", (), ()), umad, "isar").content
    targets = [task["inspection"]["inspection_target"] for task in json.loads(content)["tasks"]]
    assert [(t["x"], t["y"], t["z"]) for t in targets] == [
        navigator.site.checkpoint(id).position for id in (1, 4)
    ]
