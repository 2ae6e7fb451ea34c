"""No command overwrites its inputs or existing files, or writes two results to one path."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, Remedy
from argo_compiler.files.atomic_write import write_files_atomically
from argo_planner.terminal.words import error_text
from tests.argo_compiler.files.test_atomic_write import contents
from tests.argo_planner.conftest import argo
from tests.conftest import examples
from tests.disks import fill, small_disk
from tests.yard import measure, mission, write_yard

SCRIPT = "Mission Protocol #1\n1. Start in starting area 1.\n2. Check checkpoint #1.\n"


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("import s.txt -o s.txt", "is the input"),
        ("check m.json -o m.json", "is the input"),
        ("check m.json --site site.yaml -o site.yaml", "is the input"),
        ("compile m.json -o new.json --mermaid m.json", "is the input"),
        ("compile m.json -o new.json --mermaid ./new.json", "twice"),
        ("compile m.json -o - --mermaid -", "twice"),
        ("format m.json -o m.json", "is the input"),
        ("explain m.json -o m.json", "is the input"),
        ("export m.json --to dot -o m.json", "is the input"),
        ("export m.json --to flexbe -o m.json", "is a file"),
        ("route m.json --requirements r.yaml -o r.yaml", "is the input"),
        ("run m.json --record m.json", "m.json"),
        ("run m.json --faults f.yaml --journal f.yaml", "is the input"),
        ("run m.json --faults f.yaml --journal f.yaml --force", "is the input"),
        ("run m.json --journal new.mcap --record new.mcap", "twice"),
        ("run m.json --report m.json", "is a file"),
        ("resume j.mcap --record j.mcap --force", "is the input"),
        ("replay r.gif --render r.gif --force", "is the input"),
        ("sites site.yaml -o site.yaml", "is the input"),
    ],
)
def test_inputs_are_not_overwritten(monkeypatch, tmp_path: Path, command: str, says: str):
    monkeypatch.chdir(tmp_path)
    for name in ("s.txt", "m.json", "site.yaml", "r.yaml", "f.yaml", "j.mcap", "r.gif"):
        Path(name).write_text("mine", encoding="utf-8")
    result = argo(*command.split())
    assert isinstance(result.exception, Conflict)
    assert says in str(result.exception)
    assert {path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == {"mine"}


OUTPUTS = {
    "import s.txt -o new.json": ["new.json"],
    "check s.txt -o found.txt": ["found.txt"],
    "compile m.json -o machine.json --mermaid machine.mmd": ["machine.json", "machine.mmd"],
    "format m.json -o new.txt": ["new.txt"],
    "explain s.txt -o read.txt": ["read.txt"],
    "export m.json --to dot -o new.dot": ["new.dot"],
    "export m.json --to ros1-bag -o new.bag": ["new.bag"],
    "export m.json --to ros2-bag -o bag": ["bag/metadata.yaml"],
    "route m.json -o new.json --pictures floors": ["new.json", "floors/floor-1.png"],
    "run m.json --drive route --report report --record run.mcap --journal run.journal": [
        "report/report.html", "report/report.json", "report/site.png", "run.mcap", "run.journal",
    ],
    "run m.json --render run.gif": ["run.gif"],
    "resume old.journal --record run.mcap": ["run.mcap"],
    "replay old.mcap --report report --render run.gif": ["report/report.html", "run.gif"],
    "sites yard.yaml -o new.yaml": ["new.yaml"],
}  # fmt: skip
"""files that commands write"""
WORKING = [command for command in OUTPUTS if "old." not in command and "gif" not in command]
"""commands whose inputs exist, and that are fast"""


@pytest.fixture
def folder(monkeypatch, tmp_path: Path) -> Path:
    """Return the working folder, which contains the inputs of the commands."""
    monkeypatch.chdir(tmp_path)
    Path("s.txt").write_text(SCRIPT, encoding="utf-8")
    write_yard(tmp_path, m=mission(measure(1)))
    return tmp_path


def invoke(command: str, *more: str, status: int | None = None):
    site = [] if command.split()[0] in {"sites", "resume", "replay"} else ["--site", "yard.yaml"]
    return argo(*command.split(), *site, *more, status=status)


def put(names: list[str]) -> None:
    for name in names:
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text(f"old {name}", encoding="utf-8")


@settings(
    deadline=None,
    max_examples=examples(40),
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.data())
def test_nothing_that_is_there_is_changed_without_force(folder: Path, data) -> None:
    command = data.draw(st.sampled_from(sorted(OUTPUTS)))
    there = data.draw(st.lists(st.sampled_from(OUTPUTS[command]), min_size=1, unique=True))
    others = data.draw(st.lists(st.sampled_from(["report/notes.txt", "bag/x.db3", "a.json"])))
    try:
        put([*there, *others])
        before = contents(folder)
        result = invoke(command)
        assert isinstance(result.exception, Conflict), result.output
        assert "already exists" in str(result.exception)
        assert any(str(result.exception).startswith(name) for name in there)
        assert contents(folder) == before
    finally:
        for name in {*there, *others}:
            Path(name).unlink()


@pytest.mark.usefixtures("folder")
def test_the_message_names_the_remedy() -> None:
    put(["new.dot"])
    error = invoke("export m.json --to dot -o new.dot").exception
    assert isinstance(error, ArgoError)
    assert error.remedies == (Remedy.REPLACE,)
    assert error_text(error) == (
        "new.dot already exists: choose another path, or replace it (--force)"
    )


@pytest.mark.usefixtures("quick_picture")
@pytest.mark.parametrize("command", WORKING)
def test_with_force_the_results_are_replaced_and_nothing_else(folder: Path, command: str) -> None:
    put([*OUTPUTS[command], "report/notes.txt", "bag/notes.txt", "floors/notes.txt"])
    before = contents(folder)
    invoke(command, "--force", status=0)
    after = contents(folder)
    for name in OUTPUTS[command]:
        assert not after[name].startswith(b"old"), name
    kept = before.keys() - set(OUTPUTS[command])
    assert {name: after[name] for name in kept} == {name: before[name] for name in kept}
    assert not [name for name in after if ".tmp" in name]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    "command",
    ["import s.txt -o {}", "check s.txt -o {}", "compile m.json -o {}", "format m.json -o {}",
     "export m.json --to dot -o {}"],
)  # fmt: skip
def test_a_dash_is_standard_output(command: str) -> None:
    shown = invoke(command.format("-"), status=0)
    assert not Path("-").exists()
    invoke(command.format("kept.json"))
    assert shown.stdout == Path("kept.json").read_text(encoding="utf-8")


@pytest.mark.usefixtures("folder")
def test_only_one_text_is_shown() -> None:
    for command in ("route m.json -o -", "export m.json --to flexbe -o -", "sites yard.yaml -o -"):
        assert isinstance(invoke(command).exception, Invalid)
    assert not Path("-").exists()


@pytest.mark.usefixtures("folder")
def test_devices_are_always_written_to() -> None:
    Path("nowhere").symlink_to("/dev/null")
    for place in ("/dev/null", "nowhere"):
        assert invoke(f"compile m.json -o {place} --mermaid {place}").exit_code == 0
    assert Path("nowhere").is_symlink()


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("import s.txt -o none/new.json", "folder none does not exist"),
        ("compile m.json -o new.json --mermaid none/new.mmd", "folder none does not exist"),
        ("format m.json -o taken", "is a folder"),
        ("export m.json --to dot -o taken", "is a folder"),
        ("run m.json --report holding", "is a folder"),
        ("route m.json -o none/new.json", "folder none does not exist"),
        ("run m.json --record none/run.mcap", "folder none does not exist"),
        ("replay run.mcap --render none/film.gif", "folder none does not exist"),
    ],
)
def test_unwritable_paths_are_reported_before_any_work(command: str, says: str) -> None:
    Path("taken").mkdir()
    Path("holding/report.html").mkdir(parents=True)
    # The site is never opened.
    error = argo(*command.split(), "--force").exception
    assert isinstance(error, ArgoError)
    assert says in str(error)


@pytest.mark.small_disk
@pytest.mark.usefixtures("folder", "quick_picture")
@pytest.mark.parametrize("room", [0, 2, 5])
def test_an_old_report_stays_whole_where_the_disk_is_full(room: int) -> None:
    with small_disk(30 * 4096) as disk:
        old = {"report/report.html": b"old", "report/report.json": b"old", "report/my.txt": b"old"}
        write_files_atomically(disk, old)
        filler = fill(disk, leave=room * 4096)
        report = disk / "report"
        result = invoke(f"run m.json --drive route --force --journal kept --report {report}")
        filler.unlink()
        assert contents(disk) == old
        assert sorted(path.name for path in disk.iterdir()) == ["report"]
    assert result.exit_code == 2
    assert "MEASURE 1" in result.stdout
    assert "No space left on device" in result.stderr
    assert result.stderr.endswith(f"to try again: argo resume kept --report {report} --force\n")
