"""Each kind of run is checked exactly once, before any file is written."""

import cProfile
from collections import Counter
from types import CodeType

import pytest

from argo_env.envs.inspection import InspectEnv
from argo_env.evaluation.evaluation import Evaluation
from argo_env.evaluation.runner import WorkOrder, execute_run
from argo_env.planning.opening import open_site
from argo_env.run.journal import Header, Journal, create_journal, open_journal
from argo_env.run.run_commands import check_scheduled_events
from argo_env.run.run_setup import check_spec
from argo_env.run.session import resume, simulate
from argo_env.run.spec import RunSpec
from argo_env.run.validation import require_site
from tests.argo_planner.conftest import argo
from tests.yard import measure, mission, simulation_of, write_yard

CHECKS = (require_site, check_spec, check_scheduled_events)
ONCE = {check.__name__: 1 for check in CHECKS}
PLAN = mission(measure(2))


def counted(work, *checks):
    """Return how often each check is called while the work is done."""
    profile = cProfile.Profile()
    profile.runcall(work)
    calls = Counter(
        {e.code: e.callcount for e in profile.getstats() if isinstance(e.code, CodeType)}
    )
    return {check.__name__: calls[check.__code__] for check in checks or CHECKS}


@pytest.fixture
def folder(monkeypatch, tmp_path):
    write_yard(tmp_path, plan=PLAN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_run_of_a_mission_by_the_command(folder):
    (folder / "f.yaml").write_text("faults:\n- {kind: low_battery}\n", encoding="utf-8")
    words = ("--site", "yard.yaml", "--drive", "route", "--faults", "f.yaml", "--event", "1=pause")
    run = ("run", "plan.json", *words, "--event", "2=resume")
    assert counted(lambda: argo(*run, status=0)) == ONCE


def test_a_run_of_a_spec_by_the_command(folder):
    spec = RunSpec(mission=PLAN, site="yard.yaml", drive="route")
    (folder / "spec.json").write_text(spec.model_dump_json(), encoding="utf-8")
    assert counted(lambda: argo("run", "spec.json", status=0)) == ONCE


def test_a_run_that_is_refused_leaves_no_folder(folder):
    for words in (("--event", "1=reading:9=1"), ("--drive", "rocket")):
        argo("run", "plan.json", "--site", "yard.yaml", *words, "--report", "out", status=1)
    spec = RunSpec(mission=PLAN, site="yard.yaml", drive="rocket")
    (folder / "spec.json").write_text(spec.model_dump_json(), encoding="utf-8")
    argo("run", "spec.json", "--report", "out", status=1)
    assert not (folder / "out").exists()


def test_a_run_that_goes_on(folder):
    site, spec = open_site("yard.yaml"), RunSpec(mission=PLAN, site="yard.yaml", drive="route")
    create_journal(folder / "run.journal", Header.from_run(site, spec)).close()
    once = (*CHECKS, Journal.require_not_ended, Journal.require_inputs_unchanged)
    run = ("resume", "run.journal", "--event", "1=pause", "--event", "2=resume")
    assert set(counted(lambda: argo(*run, status=0), *once).values()) == {1}

    def again():
        with open_journal(folder / "run.journal") as journal:
            resume(journal, site)

    assert counted(again) == ONCE
    assert counted(again, Journal.require_inputs_unchanged) == {"require_inputs_unchanged": 1}


@pytest.mark.usefixtures("folder")
def test_a_run_from_python():
    site, spec = open_site("yard.yaml"), RunSpec(mission=PLAN, site="yard.yaml", drive="route")
    assert counted(lambda: simulate(spec, site)) == ONCE
    assert counted(lambda: simulation_of(spec, site).close()) == ONCE


@pytest.mark.usefixtures("folder")
def test_a_run_of_an_evaluation():
    site = open_site("yard.yaml")
    plan = Evaluation(PLAN, site, seeds=range(2)).plan
    order = WorkOrder("k", plan.cases[0], plan.planned_run(0, 1).spec, {})
    assert counted(lambda: execute_run(order, site)) == ONCE


@pytest.mark.usefixtures("folder")
def test_an_episode_of_the_environment():
    env = InspectEnv(scenario="yard.yaml", drive="route")
    assert counted(lambda: env.reset(seed=1)) == ONCE
    env.close()
