"""`argo sites`, and the small site that Argo ships."""

import re
import shlex

import numpy as np
import pytest
import yaml
from PIL import Image

from argo_compiler.diagnostics import Severity
from argo_env.files import resources
from argo_env.planning import open_site
from argo_env.site import load_site
from argo_planner.terminal.files import read_upload
from argo_planner.use_cases.checking import check_source
from tests.argo_planner.conftest import argo


@pytest.fixture
def hall_yaml():
    text = (resources.scenarios_folder() / "darmstadt" / "site.yaml").read_text("utf-8")
    return yaml.safe_load(text)


@pytest.fixture
def look_over(tmp_path):
    """Return a function that runs `argo sites` on a site with flaws, and returns its output."""

    def call(site, *options):
        (tmp_path / "site.yaml").write_text(yaml.safe_dump(site, sort_keys=False), encoding="utf-8")
        return argo("sites", tmp_path / "site.yaml", *options, status=2).output

    return call


def test_list():
    listed = argo("sites", status=0).output
    assert "darmstadt: " in listed
    assert "umad: UMAD (reconstruction), floors: 6, checkpoints: 20" in listed


def test_a_site_that_can_be_driven_and_is_written_out(tmp_path):
    file = tmp_path / "copy.yaml"
    result = argo("sites", "darmstadt", "-o", file, status=0)
    assert "note" not in result.output
    written, shipped = load_site(str(file)), load_site("darmstadt")
    assert written.name == "copy"
    assert written.spec == shipped.spec.model_copy(update={"name": "copy"})
    assert written.elements == shipped.elements
    assert f"{file}: written, site `copy`" in result.output
    taken = argo("sites", "umad", "-o", tmp_path / "darmstadt.yaml")
    assert "would be called darmstadt, like the one that Argo ships" in str(taken.exception)


DRAWN = "generated:floors=1,size=12x12,checkpoints=2,seed=1"


@pytest.mark.long
def test_a_generated_site_is_written_under_the_name_of_its_file(tmp_path):
    file = tmp_path / "my site.yaml"
    result = argo("sites", DRAWN, "-o", file, status=0)
    (use,) = re.findall(r"`(argo check .*)`", result.output)
    written, drawn = load_site(str(file)), open_site(DRAWN).site
    assert written.name == "my site"
    assert written.elements == drawn.elements
    assert written.checkpoints == drawn.checkpoints
    script = tmp_path / "mission.txt"
    script.write_text("Mission Protocol: one\n1. Set the starting point in starting area 1.\n"
                      "2. Check checkpoint #1.\n", encoding="utf-8")  # fmt: skip
    argo(*[script if a == "MISSION" else a for a in shlex.split(use)[1:]], status=0)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("site.txt", "ends in .yaml or .yml: choose such a name"),
        ("site", "ends in .yaml or .yml: choose such a name"),
        ("umad.yaml", "would be called umad"),
        ("generated:floors=2.yaml", "names a generated site, not a file"),
    ],
)
def test_file_names_that_a_site_can_not_have(tmp_path, name, says):
    result = argo("sites", DRAWN, "-o", tmp_path / name)
    assert result.exit_code != 0
    assert says in str(result.exception)
    assert not (tmp_path / name).exists()


def test_a_site_is_not_written_over_itself(tmp_path, hall_yaml):
    file = tmp_path / "site.yaml"
    file.write_text("# a person's\n" + yaml.safe_dump(hall_yaml), encoding="utf-8")
    before = file.read_bytes()
    assert "is the input as well" in str(argo("sites", file, "-o", file).exception)
    assert file.read_bytes() == before


def test_stairs_that_do_not_end_at_the_next_floor(look_over, hall_yaml):
    """This is an error even if the robot could climb the step."""
    (flight,) = hall_yaml["towers"][0]["flights"]
    flight["rise"] -= 0.05 / flight["risers"]
    (error,) = [line for line in look_over(hall_yaml).splitlines() if "its flights rise" in line]
    assert ": error: " in error
    assert "and floor 2 lies 2.500 m above floor 1" in error
    flight["rise"] *= 2  # too steep for any robot, but only the wrong height is reported
    (error,) = [line for line in look_over(hall_yaml).splitlines() if ": error: " in line]
    assert "its flights rise" in error


@pytest.mark.parametrize(
    "change", [lambda site: site.update(storey=9), lambda site: site["floors"][1].update(z=2.4)]
)
def test_a_storey_that_is_not_the_height_from_floor_to_floor(tmp_path, hall_yaml, change):
    change(hall_yaml)
    file = tmp_path / "site.yaml"
    file.write_text(yaml.safe_dump(hall_yaml, sort_keys=False), encoding="utf-8")
    line = 1 + [*hall_yaml].index("storey")
    result = argo("sites", file)
    assert result.exit_code != 0
    message = str(result.exception)
    assert (
        f"{file}:{line}:9: error: storey: it is {hall_yaml['storey']:g} m, and floor 2" in message
    )
    assert "give it the height from floor to floor" in message


def test_a_site_that_can_not_be_driven(look_over, hall_yaml):
    hall_yaml["towers"][0]["flights"][0]["foot"] = [2.0, 5.0, 0.0]
    hall_yaml["floors"][0]["checkpoints"][0]["position"][2] = 9.0
    hall_yaml["floors"][0]["checkpoints"][1]["position"][2] = 2.4
    said = look_over(hall_yaml)
    assert "error: floor 2" in said
    assert "error: checkpoint 1 (pressure gauge 1)" in said
    assert "error: checkpoints 4, 5 and 6 on floor 2 can't be read" in said
    assert "note: checkpoint 2: it is 2.4 m high" in said
    assert "checkpoint 3" not in said


def reds(picture):
    """Return the number of pixels in the colour of errors; checkpoints are orange."""
    red, green, blue = np.asarray(picture.convert("RGB")).astype(int).transpose(2, 0, 1)
    return ((red - green > 80) & (abs(green - blue) < 30)).sum()


def test_a_picture_shows_what_is_wrong_and_where(look_over, tmp_path, hall_yaml):
    hall_yaml["towers"] = []
    file, picture = tmp_path / "site.yaml", tmp_path / "site.png"
    assert f"to see where: argo sites {file} --picture FILE.png" in look_over(hall_yaml)
    assert "to see where" not in look_over(hall_yaml, "--picture", picture)
    drawn = Image.open(picture)
    assert drawn.width == 1280
    assert drawn.height > 720, "the errors stand below the floors"
    assert reds(drawn) > 1000, "floor 2 is hatched"
    before = picture.read_bytes()
    assert "already exists" in str(argo("sites", "darmstadt", "--picture", picture).exception)
    assert picture.read_bytes() == before
    assert argo("sites", "darmstadt", "--picture", picture, "--force").exit_code == 0
    drawn = Image.open(picture)
    assert drawn.size == (1280, 720)
    assert reds(drawn) == 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["darmstadt", "--picture", "a.jpg"], "choose a name that ends in .png"),
        (["--picture", "a.png"], "need a site: name one"),
    ],
)
def test_a_picture_that_can_not_be_drawn(arguments, says):
    assert says in str(argo("sites", *arguments).exception)


def test_the_shipped_mission_of_the_test_site_has_no_findings():
    site = open_site("darmstadt")
    script = resources.scenarios_folder() / "darmstadt" / "missions" / "mission_1.txt"
    findings = check_source(read_upload(script), site.catalog, 1, 2, site.travel)
    findings = [finding for finding in findings if finding.code != "script.no-effect"]
    assert {finding.severity for finding in findings} <= {Severity.NOTE}
