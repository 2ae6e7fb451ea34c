"""`argo examples` and `argo new`: what they write is used as their users would use it."""

from pathlib import Path

import pytest

from argo_env.evaluation.score import read_scoring
from argo_env.faults.loading import read_faults
from argo_env.files.resources import scenarios_folder
from argo_planner.use_cases.examples import list_examples

AREAS = {"mission_1", "darmstadt_1"}
"""missions that leave starting areas open"""
EXAMPLES = [(kind, name) for kind, examples in list_examples().items() for name in examples]


def evaluate_few_worlds(argo, file: Path) -> None:
    """Evaluate with fewer worlds than the file has; the requirements may stay open."""
    text = file.read_text(encoding="utf-8")
    assert "seeds: 0..199 " in text
    file.write_text(text.replace("seeds: 0..199 ", "seeds: 0..2 "), encoding="utf-8")
    result = argo("evaluate", file.name, cwd=file.parent)
    assert result.returncode in (0, 1), result.stderr


def test_examples_are_all_shipped_files_under_unique_names() -> None:
    names = [name for _, name in EXAMPLES if name != "falling_pressure"]
    assert len(set(names)) == len(names)
    listed = {e.files[0] for examples in list_examples().values() for e in examples.values()}
    shipped = {
        p.relative_to(scenarios_folder()).as_posix() for p in scenarios_folder().rglob("*.*")
    }
    assert listed == {p for p in shipped if not p.endswith(".md")} - {"examples.yaml"}


@pytest.mark.parametrize(("kind", "name"), EXAMPLES, ids=[name for _, name in EXAMPLES])
def test_each_example_is_valid_in_the_folder_to_which_it_is_copied(
    argo, tmp_path, kind, name
) -> None:
    copied = argo("examples", "copy", name, cwd=tmp_path, status=0).stdout.splitlines()
    file = copied[0].removesuffix(": copied")
    assert {tmp_path / line.removesuffix(": copied") for line in copied} == {
        path for path in tmp_path.rglob("*") if path.is_file()
    }
    if kind == "missions":
        site = "darmstadt" if name == "darmstadt_1" else "umad"
        areas = ("--start-area", 1, "--end-area", 2) if name in AREAS else ()
        argo("check", file, "--site", site, *areas, cwd=tmp_path, status=0)
    elif kind == "sites":
        argo("sites", file, cwd=tmp_path, status=0)
    elif kind == "evaluations":
        evaluate_few_worlds(argo, tmp_path / file)
        assert [*(tmp_path / "out" / "evaluations").glob("*/report.html")]
    elif kind == "faults":
        assert read_faults(tmp_path / file)
    else:
        read_scoring(tmp_path / file)


def test_a_file_that_two_examples_need_is_copied_once(argo, tmp_path) -> None:
    argo("examples", "copy", "gas_leak", cwd=tmp_path, status=0)
    output = argo("examples", "copy", "hot_spot", cwd=tmp_path, status=0).stdout
    assert output.splitlines() == ["hot_spot.yaml: copied", "ground.txt: already there"]
    (tmp_path / "ground.txt").write_text("mine")
    argo("examples", "copy", "brick", cwd=tmp_path, status=2)
    assert (tmp_path / "ground.txt").read_text() == "mine"
    assert not (tmp_path / "brick.yaml").exists()


def test_examples_are_listed_with_a_line_each(argo) -> None:
    listed = argo("examples", status=0).stdout
    for _, name in EXAMPLES:
        assert any(line.split()[0] == name for line in listed.splitlines()), name


@pytest.mark.physics
@pytest.mark.parametrize("site", [pytest.param("umad", marks=pytest.mark.long), "plant.yaml"])
def test_skeletons_are_valid_and_used_together(argo, tmp_path, site) -> None:
    argo("new", "site", "plant", cwd=tmp_path, status=0)
    argo("sites", "plant.yaml", cwd=tmp_path, status=0)
    for kind, name in (("mission", "tour"), ("evaluation", "tour"), ("faults", "bad_day")):
        argo("new", kind, name, "--site", site, cwd=tmp_path, status=0)
    checked = argo("check", "tour.txt", "--site", site, "--strict", cwd=tmp_path, status=0)
    assert "warning" not in checked.stdout + checked.stderr
    run = ("run", "tour.txt", "--site", site, "--faults", "bad_day.yaml")
    output = argo(*run, cwd=tmp_path, status=0).stdout
    assert "Done, 2 findings" in " ".join(output.split())
    evaluate_few_worlds(argo, tmp_path / "tour.yaml")
    assert (tmp_path / "out" / "evaluations" / "tour" / "report.html").exists()


def test_a_missing_mission_of_an_evaluation_is_named(argo, tmp_path) -> None:
    said = argo("new", "evaluation", "tour", cwd=tmp_path, status=0).stdout
    assert "tour.txt does not exist yet: argo new mission tour --site umad" in said


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("examples copy gas_leek", "there is no example gas_leek: did you mean gas_leak?"),
        ("examples copy 123456789", "choose one of: mission_1, "),
        ("examples copy", "give the name of the example"),
        (
            "examples remove gas_leak",
            "there is no `argo examples remove`; `argo examples copy NAME` copies one",
        ),
        ("examples gas_leak", "`argo examples copy gas_leak` copies it"),
        ("new site umad", "like the one that Argo ships; choose another name"),
        ("new site a/b", "`a/b` can't be a name"),
        ("new mission ../out", "`../out` can't be a name"),
        ("new mission taken", "taken.txt already exists"),
        ("new mission tour --site nowhere", "nowhere"),
        ("new robot r2", "robot"),
    ],
)
def test_wrong_arguments_get_one_message_and_write_nothing(
    argo, tmp_path: Path, command: str, message: str
) -> None:
    (tmp_path / "taken.txt").write_text("mine")
    result = argo(*command.split(), cwd=tmp_path, status=2)
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["taken.txt"]
    assert (tmp_path / "taken.txt").read_text() == "mine"
