"""`argo export`: files, folders, and messages for what a format can't express."""

import xml.etree.ElementTree as ET

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export import EXPORTERS
from argo_compiler.files.mission_file import write_mission
from argo_compiler.il import EventKind, Mission, Reaction, Response
from tests.argo_planner.conftest import argo
from tests.mission_writing import measure

TASKS = measure("A", "B", object_id="1"), measure("B", object_id="4")


@pytest.fixture
def export(tmp_path):
    def export(mission, to, output="out"):
        source = tmp_path / "mission.json"
        write_mission(mission, source)
        result = argo("export", source, "--to", to, "-o", tmp_path / output)
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return tmp_path / output

    return export


@pytest.mark.parametrize("to", [name for name in EXPORTERS if not name.startswith("ros")])
def test_every_format_is_written(export, to):
    output = export(Mission(tasks=TASKS), to)
    files = [output] if output.is_file() else [p for p in output.rglob("*") if p.is_file()]
    assert files
    assert any("A" in path.read_text(encoding="utf-8") for path in files)
    assert output.is_file() == bool(EXPORTERS[to].suffixes)


def test_all_that_a_format_can_not_express_is_reported(export):
    reaction = Reaction(event=EventKind.GAS_LEAK, response=Response.PAUSE)
    back = measure("B", "A", object_id="4")
    mission = Mission(tasks=(TASKS[0], back), reactions=(reaction,))
    with pytest.raises(DiagnosticError, match=r"mission\.json") as caught:
        export(mission, "btcpp")
    assert [d.code for d in caught.value.diagnostics] == ["export.reaction", "export.backward"]


def test_an_unknown_format_is_refused_with_the_known_ones(export):
    with pytest.raises(ArgoError, match=r"--to word: no format `word`; .*scxml.*isar"):
        export(Mission(tasks=TASKS), "word")


def test_a_folder_does_not_replace_a_file(export, tmp_path):
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(ArgoError, match="folder"):
        export(Mission(tasks=TASKS), "flexbe", "taken")
    assert (tmp_path / "taken").read_text() == "mine"


def test_scxml_is_xml_with_the_names(export):
    root = ET.parse(export(Mission(tasks=TASKS), "scxml")).getroot()
    names = {element.get("{urn:argo:mission}name") for element in root.iter()}
    assert {"A", "B"} <= names
