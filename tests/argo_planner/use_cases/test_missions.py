"""Use cases from bytes, without files: check, compile, export, reorder, run."""

import json

import pytest

from argo_compiler.base.errors import Conflict, Invalid, NotFound, Remedy
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export import EXPORTERS
from argo_compiler.files.mission_file import mission_text
from argo_compiler.hfsm import Hfsm, Occurred, Pause
from argo_compiler.il import EventKind, Order
from argo_env.faults.loading import decode_faults
from argo_env.planning import open_site
from argo_env.report.files import PAGE
from argo_env.run.record import RunRecord
from argo_env.run.run_setup import check_spec
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.use_cases.checking import Format, check_source, format_diagnostics
from argo_planner.use_cases.compiling import compile_mission
from argo_planner.use_cases.exporting import export_mission, to_script
from argo_planner.use_cases.importing import Upload, import_mission
from argo_planner.use_cases.no_order import require_order
from argo_planner.use_cases.reporting import report_files
from argo_planner.use_cases.routing import (
    parse_requirements,
    require_any_time_limit,
    suggest_order,
)
from argo_planner.use_cases.running import (
    NO_MISSION,
    parse_event,
    with_mission,
)
from argo_planner.use_cases.schemas import FileKind, schema
from argo_planner.use_cases.sites import list_shipped_sites, make_site_report, site_yaml_with_name
from tests.yard import measure, mission, waypoint

DOCK = Pose(x=1.05, y=1.05, z=0.02)
PLAN = mission(
    measure(2), measure(3), measure(1), waypoint("DOCK", 1.05, 1.05),
    order=Order.ANY, dock=DOCK, start_area=1, end_area=1,
)  # fmt: skip
UPLOAD = Upload("plan.json", mission_text(PLAN).encode())


@pytest.fixture(scope="module")
def imported(site):
    return import_mission(UPLOAD, site)


def test_checking(site):
    assert check_source(UPLOAD, site.catalog, travel=site.travel) == ()
    broken = Upload("a.json", b'{"tasks": [{"name": "A", "action": "MEASURE"}]}')
    found = check_source(broken, site.catalog)
    assert "il.measure-without-object" in {d.code for d in found}
    assert json.loads(format_diagnostics(found, "a.json", Format.JSON))["errors"] == 1
    (unreadable,) = check_source(Upload("a.txt", b""), site.catalog)
    assert unreadable.code == "script.unreadable"
    with pytest.raises(Invalid):
        check_source(UPLOAD, site.catalog, start_area=1)


def test_compiling(imported):
    compiled = compile_mission(imported)
    assert Hfsm.model_validate_json(compiled.json) == compiled.machine
    assert compiled.mermaid.startswith("stateDiagram")


def test_a_script_gives_the_mission_again(imported, site):
    again = import_mission(Upload("plan.txt", to_script(imported, site).encode()), site)
    assert [t.object_id for t in again.mission.tasks] == [t.object_id for t in PLAN.tasks]


@pytest.mark.parametrize("format", EXPORTERS.names())
def test_exporting(imported, site, format):
    exported = export_mission(imported, site, format)
    assert exported.content
    assert exported.description


def test_unknown_formats_are_refused(imported, site):
    with pytest.raises(NotFound, match="no format `word`; choose one of: scxml"):
        export_mission(imported, site, "word")


def test_a_best_order(imported, site):
    found = suggest_order(imported, site, parse_requirements(b"before:\n- [3, 1]\n", "wanted"))
    require_order(found, "plan.json")
    order = found.reordering.order
    assert order.index("MEASURE 3") < order.index("MEASURE 1")
    assert found.reordering.proven
    assert sorted(t.name for t in found.mission.tasks) == sorted(t.name for t in PLAN.tasks)


def test_no_order_is_a_conflict_that_names_no_option(imported, site):
    wanted = parse_requirements(b"budget: 3 s\n", "wanted")
    with pytest.raises(Conflict, match="nothing fits within the budget 3 s") as caught:
        require_order(suggest_order(imported, site, wanted), "plan.json")
    assert "--" not in str(caught.value)
    with pytest.raises(DiagnosticError, match=r"wanted:1:1.*route\.wrong-field"):
        parse_requirements(b"budgets: 3 s\n", "wanted")
    with pytest.raises(Invalid, match="nothing limits") as unlimited:
        require_any_time_limit(PLAN, parse_requirements(b"mandatory: [1]\n", "wanted"))
    assert unlimited.value.remedies == (Remedy.GIVE_BUDGET,)


def test_a_run_with_its_report(imported, site):
    faults = decode_faults(b"faults:\n- {kind: gas_leak, at: 1, place: [3, 3, 0.5]}\n", "f")
    draft = RunSpec(mission=NO_MISSION, site=site.reference, drive="route", seed=3)
    with pytest.raises(Invalid, match="no drive `rocket`"):
        check_spec(draft.model_copy(update={"drive": "rocket"}), site.site)
    with pytest.raises(Invalid):  # without a world no gas can be found
        check_spec(draft.model_copy(update={"faults": faults.faults}), site.site, faults)
    check_spec(draft, site.site)
    spec = with_mission(draft, imported)
    record = simulate(RunSpec.model_validate_json(spec.model_dump_json()), site)
    files = report_files(record, site.site, site.robot)
    assert RunRecord.model_validate_json(files["report.json"]) == record
    assert b"<html" in files[PAGE]
    assert files["site.png"].startswith(b"\x89PNG")


def test_events_by_name():
    assert parse_event("pause") == Pause()
    assert parse_event("gas_leak") == Occurred(EventKind.GAS_LEAK)
    with pytest.raises(NotFound, match="no event `flood`"):
        parse_event("flood")
    with pytest.raises(Invalid, match="by itself"):
        parse_event("time_up")


def test_sites(site, tmp_path):
    def uploaded(content):
        path = tmp_path / "mine.yaml"
        path.write_bytes(content)
        return open_site(str(path))

    assert {one.name for one in list_shipped_sites()} >= {"umad", "darmstadt"}
    report = make_site_report(site)
    assert report.errors == ()
    mine = site_yaml_with_name(site, "mine")
    again = uploaded(mine.encode())
    assert again.name == "mine"
    assert uploaded(mine.encode("utf-16")).site == again.site
    assert again.site.checkpoints == site.site.checkpoints
    with pytest.raises(DiagnosticError, match=r"mine.yaml:1:1: error: titel"):
        uploaded(b"titel: Mine\n")
    with pytest.raises(Invalid, match=r"mine.yaml is not UTF-8"):
        uploaded(b"\xff")
    with pytest.raises(Conflict, match="would be called umad"):
        site_yaml_with_name(site, "umad")


@pytest.mark.parametrize("kind", FileKind)
def test_schemas(kind):
    assert json.loads(schema(kind))["title"].startswith("Argo")
