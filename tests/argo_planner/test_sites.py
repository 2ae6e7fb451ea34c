"""`argo sites`, and the small test site that is shipped."""

import pytest
import yaml
from typer.testing import CliRunner

from argo_compiler.diagnostics import has_errors
from argo_env import resources
from argo_env.catalog import make_catalog
from argo_env.navigation import Navigator
from argo_env.robot.spec import load_robot
from argo_env.site import load_site
from argo_env.travel import SiteTravel
from argo_planner.cli import app
from argo_planner.commands.check import find_all


def argo(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture
def hall_yaml():
    text = (resources.scenarios() / "darmstadt" / "site.yaml").read_text("utf-8")
    return yaml.safe_load(text)


def test_list():
    result = argo("sites")
    assert result.exit_code == 0
    assert "darmstadt: " in result.output
    assert "umad: UMAD (reconstruction), floors: 6, checkpoints: 20" in result.output


def test_a_site_that_can_be_driven_and_is_written_out(tmp_path):
    file = tmp_path / "copy.yaml"
    result = argo("sites", "darmstadt", "-o", file)
    assert result.exit_code == 0
    assert "note" not in result.output
    assert load_site(str(file)) == load_site("darmstadt")


def test_a_site_that_can_not_be_driven(tmp_path, hall_yaml):
    hall_yaml["towers"][0]["flights"][0]["foot"] = [2.0, 5.0, 0.0]
    hall_yaml["floors"][0]["checkpoints"][0]["position"][2] = 9.0
    hall_yaml["floors"][0]["checkpoints"][1]["position"][2] = 2.4
    file = tmp_path / "site.yaml"
    file.write_text(yaml.safe_dump(hall_yaml), encoding="utf-8")
    result = argo("sites", file)
    assert result.exit_code == 2
    assert "error: floor 2" in result.output
    assert "error: checkpoint 1 (pressure gauge 1)" in result.output
    assert "error: checkpoint 5" in result.output
    assert "note: checkpoint 2: it is 2.4 m high" in result.output
    assert "checkpoint 3" not in result.output


def test_the_shipped_mission_of_the_test_site_has_no_findings():
    navigator = Navigator(load_site("darmstadt"), load_robot())
    script = resources.scenarios() / "darmstadt" / "missions" / "mission_1.txt"
    findings = find_all(script, make_catalog(navigator), 1, 2, SiteTravel(navigator))
    assert not has_errors(findings)
    assert findings == ()
