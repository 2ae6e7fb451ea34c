"""`docs/stability.md` names the packages and the versions of files that the code has."""

import ast
import re
import tomllib

import gymnasium
import pytest

import argo_env
from argo_compiler.diagnostics import json_format
from argo_compiler.files import migration, route_problem_file
from argo_compiler.hfsm import Hfsm
from argo_compiler.script.drafts import draft_file
from argo_env.recording import output
from argo_env.run import journal
from argo_env.run.record import RunRecord
from argo_planner.service.storage import plan_file
from tests.processes import ROOT
from tests.source import trees

PAGE = (ROOT / "docs" / "stability.md").read_text(encoding="utf-8")
VERSIONS = {
    "mission (": migration.VERSION,
    "[draft]": draft_file.VERSION,
    "state machine": Hfsm.model_fields["version"].default,
    "record of a run": RunRecord.model_fields["version"].default,
    "[journal]": journal.VERSION,
    "[recording]": output.VERSION,
    "mission plan": plan_file.VERSION,
    "[route problem]": route_problem_file.VERSION,
    "[ROS messages]": migration.VERSION,
    "[diagnostics]": json_format.VERSION,
}
"""versions of formats, by the beginnings of their rows"""


def names_all(tree: ast.Module) -> bool:
    """Return True if a module defines `__all__`."""
    return any(
        isinstance(n, ast.Assign) and ast.unparse(n.targets[0]) == "__all__" for n in tree.body
    )


def test_the_packages_with_public_names_are_listed() -> None:
    _, listed, _ = re.split("<!-- packages -->|<!-- end -->", PAGE)
    packages = {
        ".".join(path.parent.parts)
        for path, tree in trees().items()
        if path.name == "__init__.py" and names_all(tree)
    }
    assert set(re.findall(r"`([\w.]+)`", listed)) == packages


@pytest.mark.parametrize("row", VERSIONS)
def test_the_version_of_a_format_is_stated(row: str) -> None:
    (version,) = re.findall(rf"^\| {re.escape(row)}.*? \| (\d+) \|", PAGE, re.M)
    assert version == str(VERSIONS[row])


def test_all_formats_with_a_version_are_listed() -> None:
    _, table, _ = re.split(r"## Formats of files\n|A refusal names", PAGE)
    assert len(re.findall(r"^\| .* \| \d+ \|", table, re.M)) == len(VERSIONS)


def test_the_ids_of_the_environments_are_listed() -> None:
    assert argo_env
    ids = {name for name in gymnasium.registry if name.startswith("argo/")}
    (listed,) = re.findall(r"\*\*Ids of Gymnasium environments\*\*: (.*?)\. A change", PAGE, re.S)
    assert set(re.findall(r"`([^`]+)`", listed)) == ids


def test_the_packages_of_the_wheel_are_listed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wheel = project["tool"]["hatch"]["build"]["targets"]["wheel"]
    data = {"docs/**/*.md", "scenarios", "urdf"}
    packages = {path.strip("/") for path in wheel["include"]} - data
    (listed,) = re.findall(r"installs four packages: (.*?)\.", PAGE, re.S)
    assert set(re.findall(r"`(\w+)`", listed)) == packages
