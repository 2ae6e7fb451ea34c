"""The command `argo` as a whole: its list of commands, imports, misspelt words, completion."""

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from argo_planner.cli import ArgoCommands, app
from argo_planner.lazy_group import LazyCommand, load_command
from tests.processes import run_python
from tests.yard import write_site

COMMANDS = {command.name: command for command in ArgoCommands.lazy_commands}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=lambda command: command.name)
def test_each_command_is_listed_with_the_line_that_it_has_itself(command: LazyCommand) -> None:
    assert load_command(command).help == command.help


def test_the_help_lists_the_commands_in_their_order() -> None:
    shown = CliRunner().invoke(app, ["--help"], env={"COLUMNS": "200"}).output
    places = [shown.index(f"│ {name} ") for name in COMMANDS]
    assert places == sorted(places)
    assert all(command.help in shown for command in COMMANDS.values())


def test_the_help_of_a_command_has_its_options() -> None:
    shown = CliRunner().invoke(app, ["check", "--help"], env={"COLUMNS": "200"}).output
    assert "--strict" in shown
    assert "exit with status 1 if there are warnings" in shown


def test_a_misspelt_command_is_answered_with_the_ones_that_are_like_it() -> None:
    answer = CliRunner().invoke(app, ["chek"], env={"COLUMNS": "200"})
    assert answer.exit_code == 2
    assert "Did you mean 'check'" in answer.output


MODULES = (
    "import sys; from argo_planner.cli import main\n"
    "try: main()\n"
    "except SystemExit: print(*sys.modules, file=sys.stderr)"
)
"""program that runs a command and then prints the imported modules"""


def test_help_and_version_import_no_command_and_none_of_what_commands_need() -> None:
    for option in ("--help", "--version"):
        loaded = set(run_python("-c", MODULES, option).stderr.split())
        assert "argo_planner.cli" in loaded
        assert not loaded & {"numpy", "pydantic", "scipy", "gymnasium", "argo_env"}
        assert not {name for name in loaded if name.startswith("argo_planner.commands.")}


def test_a_repeated_check_imports_neither_numpy_nor_yaml(tmp_path: Path) -> None:
    script = tmp_path / "script.txt"
    script.write_text("Start in starting area 1. Read checkpoint 1.\n", encoding="utf-8")
    command = ["check", str(script), "--site", write_site(tmp_path / "yard.yaml")]
    run_python("-c", MODULES, *command)
    loaded = set(run_python("-c", MODULES, *command).stderr.split())
    assert "argo_env.planning.travel" in loaded
    assert not loaded & {
        "numpy",
        "scipy",
        "yaml",
        "argo_env.navigation.navigator",
        "argo_env.site.build",
    }


def complete(shell: str, words: str) -> str:
    """Return the completions that a shell gets when a person presses Tab after these words."""
    asked = {
        "bash": {"COMP_WORDS": words, "COMP_CWORD": str(len(words.split(" ")) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": words},
        "fish": {"_TYPER_COMPLETE_ARGS": words, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    program = "import sys; sys.argv = ['argo']\nimport argo_planner.cli as c; c.main()"
    environment = {**os.environ, **asked, "_ARGO_COMPLETE": f"complete_{shell}"}
    ran = run_python("-c", program, env=environment, check=False)
    assert not ran.stderr
    return ran.stdout


@pytest.mark.parametrize(
    "shell", ["bash", *(pytest.param(name, marks=pytest.mark.long) for name in ("zsh", "fish"))]
)
def test_a_shell_completes_commands_and_options(shell: str) -> None:
    assert "check" in complete(shell, "argo ch")
    assert "compile" not in complete(shell, "argo ch")
    assert "--strict" in complete(shell, "argo check --s")
    assert "--site" in complete(shell, "argo check --s")


def test_bash_completes_choices() -> None:
    assert complete("bash", "argo check --format ").split() == ["text", "json", "sarif"]
    assert complete("bash", "argo schema ma").split() == ["machine"]


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("argo run m.json --drive k", ["kinematic"]),
        ("argo run m.json --sensor ", ["ideal", "camera"]),
        ("argo export m.json --to merm", ["mermaid"]),
        ("argo check m.json --site um", ["umad"]),
        ("argo sites darm", ["darmstadt"]),
    ],
)
def test_bash_completes_names(words: str, offered: list[str]) -> None:
    assert complete("bash", words).split() == offered


def test_files_are_left_to_the_shell() -> None:
    assert not complete("bash", "argo check scen").strip()
    assert "_files" in complete("zsh", "argo check scen")
