"""`argo evaluate` as a person uses it: files, wrong input, kills, and what failed made again."""

import os
import random
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import pytest

from argo_compiler.base.errors import NotFound
from argo_env.evaluation.store import LOG, read_rows
from tests.conftest import FIRST_SEED, examples
from tests.e2e.conftest import ROOT, reported, started
from tests.e2e.test_errors import refused

pytestmark = pytest.mark.long

MISSION = "scenarios/umad/missions/mission_1.txt"
AREAS = ("--start-area", "1", "--end-area", "2")

FILE = """\
name: stops
missions:
- file: {mission}
  name: mission 1
  start_area: 1
  end_area: 2
faults: [none, stop.yaml]
seeds: 0..{last}
worlds:
  speed: [0.8, 1.0]
"""
STOP = "faults: [{kind: emergency_stop, at: 30}]\n"


def written(folder: Path, last: int = 4) -> Path:
    """Return the file of an evaluation up to the seed `last`, written into a folder."""
    (folder / "stop.yaml").write_text(STOP)
    path = folder / "evaluation.yaml"
    path.write_text(FILE.format(mission=ROOT / MISSION, last=last))
    return path


@pytest.fixture(scope="module", autouse=True)
def known_ways(argo) -> None:
    """Let no command and no worker of one look for the ways of the mission again."""
    argo.drive(ROOT / MISSION, 1, 2)


@pytest.fixture
def file(tmp_path) -> Path:
    return written(tmp_path)


@pytest.fixture(scope="module")
def evaluated(argo, tmp_path_factory) -> tuple[Path, str]:
    """The folder of an evaluation, and what the command has printed."""
    folder = tmp_path_factory.mktemp("evaluated")
    said = argo("evaluate", written(folder), "--out", folder / "out", status=0)
    return folder / "out", said.stdout


@pytest.fixture
def out(evaluated, tmp_path) -> Path:
    """The folder of the evaluation that `file` asks for."""
    return shutil.copytree(evaluated[0], tmp_path / "out")


def test_a_file_is_evaluated_and_what_failed_is_made_again(argo, file, tmp_path):
    out = tmp_path / "out"
    said = argo("evaluate", file, "--out", out, "--workers", "2", status=0)
    assert "5 of 10 runs did not succeed" in said.stdout
    assert "stop" in said.stdout
    rows = read_rows(out)
    assert len(rows) == 10
    failed = [row for row in rows if not row.success]
    assert {row.faults for row in failed} == {"stop"}
    spec = out / "failing" / f"{failed[0].key}.json"
    assert f"argo run {spec}" in said.stdout
    argo("run", spec, "--report", tmp_path / "alone", status=1)
    record = reported(tmp_path / "alone")
    assert (record.result.duration, record.seed) == (failed[0].duration, failed[0].seed)
    assert "which sets --seed itself" in refused(argo("run", spec, "--seed", "3"))


def test_again_does_nothing_and_says_the_same(argo, file, evaluated, out):
    again = argo("evaluate", file, "--out", out, status=0)
    assert again.stdout == evaluated[1].replace(str(evaluated[0]), str(out))


def test_requirements_are_in_the_exit_status(argo, tmp_path):
    options = (MISSION, *AREAS, "--seeds", "0..199", "--out", tmp_path / "out")
    met = argo("evaluate", *options, "--require", "success >= 0.5", status=0)
    assert "success >= 0.5: met" in met.stdout
    assert len(read_rows(tmp_path / "out")) < 100
    missed = argo(
        "evaluate", MISSION, *AREAS, "--seeds", "0..99", "--out", tmp_path / "other",
        "--require", "contact >= 0.5", status=1,
    )  # fmt: skip
    assert "missed" in missed.stdout


def test_two_evaluations_are_compared(argo, file, out, tmp_path):
    other = tmp_path / "other"
    assert argo("evaluate", file, "--out", other).returncode == 0
    said = argo("evaluate", "--compare", out, other, status=0)
    assert "No difference is shown." in said.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "name an evaluation file or missions"),
        (("nowhere.yaml",), "nowhere.yaml"),
        ((MISSION, "--seeds", "9..1"), "seeds `9..1`"),
        ((MISSION, "--drive", "hover"), "no drive `hover`"),
        ((MISSION, *AREAS, "--policy", "luck"), "no policy `luck`"),
        ((MISSION, *AREAS, "--policy", "os:getcwd"), "policy `os:getcwd`"),
        ((MISSION, *AREAS, "--require", "fun >= 0.5"), "no quantity `fun`"),
        ((MISSION, *AREAS, "--faults", "nothing.yaml"), "nothing.yaml"),
        ((MISSION, *AREAS, "--backend", "abacus"), "no back end `abacus`"),
        ((MISSION, *AREAS, "--width", "3"), "--width: `width` has to be less than 1"),
        ((MISSION, *AREAS, "--seeds", "0..2000000"), "1,000,000 seeds at most"),
        ((MISSION, *AREAS, "--plan", "a"), "--compare"),
        ((MISSION, *AREAS, "--backend", "dask", "--address", "127.0.0.1:9"), "Connection refused"),
        (
            (MISSION, *AREAS, "--drive", "kinematic", "--control", "route", "--seeds", "0..5"),
            "takes at least 10 worlds",
        ),
        (("--compare", "here", "there"), "here"),
        (("--compare", "here", "there", "--seeds", "0..3"), "runs nothing: leave --seeds out"),
        ((MISSION, "--compare", "here", "there"), "leave the missions out"),
    ],
)
def test_wrong_input_gets_one_message(argo, tmp_path, arguments, message):
    assert message in refused(argo("evaluate", *arguments, "--out", tmp_path / "out"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("missions: []\n", "missions"),
        ("missions: [a.txt]\nseeds: x\n", "seeds"),
        ("missions: [a.txt]\nseeds: 1e9\n", "write them as 0..999"),
        ("missions: [a.txt]\nseeds: {first: 1}\n", "write them as 0..999"),
        (
            "missions: [a.txt]\nworlds: {speed: fast}\n",
            "give a number, or the smallest and the largest",
        ),
        ("missions: [a.txt]\nworlds: {speed: [0.8, 0.9, 1]}\n", "the smallest and the largest"),
        ("missions: [a.txt]\nworlds: {speed: .nan}\n", "give a number"),
        ("missions: [a.txt]\nworlds: {speed: [0.9, 1.4]}\n", "speed"),
        ("missions: [a.txt\n", "is not YAML"),
        ("missions: [a.txt]\nmission: [b]\n", "mission"),
        ("missions: [a.txt]\nrequire: ['luck >= 1']\n", "luck"),
    ],
)
def test_a_wrong_file_says_where(argo, tmp_path, text, message):
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    said = refused(argo("evaluate", path, "--out", tmp_path / "out"))
    assert "wrong.yaml:" in said
    assert message in said
    assert not (tmp_path / "out").exists()


def test_another_evaluation_is_not_overwritten(argo, out):
    said = refused(argo("evaluate", MISSION, *AREAS, "--seeds", "0..1", "--out", out))
    assert "has another evaluation" in said
    assert "--force" in said


def test_what_a_file_says_is_not_said_by_options_as_well(argo, file, tmp_path):
    said = refused(argo("evaluate", file, "--out", tmp_path / "out", "--drive", "kinematic"))
    assert "write --drive into the file" in said


def test_faults_that_have_changed_are_not_those_of_before(argo, file, out, tmp_path):
    (tmp_path / "stop.yaml").write_text(STOP.replace("at: 30", "at: 40"))
    assert "has another evaluation" in refused(argo("evaluate", file, "--out", out))
    assert argo("evaluate", file, "--out", out, "--force").returncode == 0
    began = {one.began for row in read_rows(out) for one in row.detections}
    assert began == {40.0}


def test_of_an_evaluation_that_is_replaced_only_what_fits_is_kept(argo, file, out):
    before = {row.key: row for row in read_rows(out)}
    assert len(list((out / "failing").iterdir())) == 5
    assert len(list((out / "parts").glob("*.parquet"))) == 1
    file.write_text(FILE.format(mission=ROOT / MISSION, last=2).replace("none, ", ""))
    said = argo("evaluate", file, "--out", out, "--force")
    assert "3 of 3 runs" in said.stdout
    after = {row.key: row for row in read_rows(out)}
    assert len(after) == 3
    assert after.items() < before.items()
    assert {path.stem for path in (out / "failing").iterdir()} == set(after)


def test_files_of_others_are_not_written_over(argo, file, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("somebody's own")
    assert "report.html: already exists" in refused(argo("evaluate", file, "--out", out))
    assert (out / "report.html").read_text() == "somebody's own"
    assert argo("evaluate", file, "--out", out, "--force").returncode == 0
    assert argo("evaluate", file, "--out", out).returncode == 0
    assert argo("evaluate", "--compare", out, out).returncode == 0
    again = refused(argo("evaluate", "--compare", out, out))
    assert "comparison.html: already exists" in again
    assert argo("evaluate", "--compare", out, out, "--out", tmp_path / "other").returncode == 0
    assert (tmp_path / "other" / "comparison.html").exists()


@pytest.mark.parametrize("name", ["parts", "failing", "rows.log", "evaluation.json", "report.html"])
def test_what_is_in_the_way_is_named_before_anything_runs(argo, file, tmp_path, name):
    out = tmp_path / "out"
    out.mkdir()
    if name in ("parts", "failing"):
        (out / name).touch()
    else:
        (out / name).mkdir()
    said = argo("evaluate", file, "--out", out, "--force")
    assert str(out / name) in refused(said)
    assert said.stdout == ""


def test_plans_of_one_evaluation_are_compared_by_name(argo, tmp_path):
    out = tmp_path / "out"
    options = ("--seeds", "0..9", "--out", out, "--policy", "as written", "--policy", "optimised")
    assert argo("evaluate", MISSION, *AREAS, *options).returncode == 0
    unclear = refused(argo("evaluate", "--compare", out, out))
    assert "mission_1, as written; mission_1, optimised (--plan)" in unclear
    named = ("--plan", "mission_1, as written", "--plan", "mission_1, optimised")
    said = argo("evaluate", "--compare", out, out, *named, status=0)
    assert "A: mission_1, as written" in said.stdout
    wrong = argo("evaluate", "--compare", out, out, "--plan", "mission_2", "--no-report")
    assert "no plan `mission_2`" in wrong.stderr


def test_an_evaluation_of_which_no_run_could_be_carried_out_is_no_success(argo, file, tmp_path):
    text = file.read_text().replace("speed: [0.8, 1.0]", "ahead: 0.7")
    file.write_text(text.replace("seeds: 0..4", "seeds: 0..1").replace(", stop.yaml", ""))
    said = argo("evaluate", file, "--out", tmp_path / "out", status=1)
    assert "no run could be carried out" in said.stderr
    assert "are in no rate" in said.stdout


def test_failing_runs_name_their_plan(argo, file, tmp_path):
    file.write_text(file.read_text() + "policies: [as written, optimised]\n")
    said = argo("evaluate", file, "--out", tmp_path / "out")
    assert "  mission 1, optimised, seed 0, stop: " in said.stdout


def test_more_seeds_go_on_from_the_rows_that_are_there(argo, file, out):
    before = {row.key for row in read_rows(out)}
    file.write_text(FILE.format(mission=ROOT / MISSION, last=6))
    assert argo("evaluate", file, "--out", out).returncode == 0
    after = {row.key for row in read_rows(out)}
    assert before < after
    assert len(after) == 14


def begun(file: Path, out: Path, stderr: int = subprocess.DEVNULL) -> subprocess.Popen[str]:
    options = {"stdout": subprocess.DEVNULL, "stderr": stderr, "start_new_session": True}
    arguments = ("evaluate", file, "--out", out, "--workers", 2, "--no-report")
    return started(*arguments, cwd=ROOT, **options)


def processes_of(session: int) -> list[int]:
    """The other processes of a session."""
    found = []
    for name in os.listdir("/proc"):
        if not name.isdecimal() or int(name) == session:
            continue
        try:
            stat = Path(f"/proc/{name}/stat").read_text()
            line = Path(f"/proc/{name}/cmdline").read_bytes()
        except OSError:
            continue
        if int(stat.rpartition(")")[2].split()[3]) == session and b"resource_tracker" not in line:
            found.append(int(name))
    return found


@pytest.fixture(scope="module")
def long_file(tmp_path_factory) -> Path:
    return written(tmp_path_factory.mktemp("long"), last=59)


KILLS = examples(20)
WORLDS = max(30, 3 * KILLS)
"""as many as leave some rows between two kills, and after the last one"""


@pytest.fixture(scope="module")
def killed_file(tmp_path_factory) -> Path:
    return written(tmp_path_factory.mktemp("killed"), last=WORLDS - 1)


@pytest.fixture(scope="module")
def undisturbed(argo, killed_file, tmp_path_factory):
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    assert argo("evaluate", killed_file, "--out", out, "--no-report").returncode == 0
    return sorted(read_rows(out), key=lambda row: row.key)


def test_killed_and_begun_again_the_rows_are_those_of_an_undisturbed_one(
    argo, killed_file, undisturbed, tmp_path
):
    """SIGKILL to the command, at any moment; each row that it had told stays, once."""
    chosen, out = random.Random(KILLS + FIRST_SEED), tmp_path / "out"
    done = 0
    for _ in range(KILLS):
        process = begun(killed_file, out)
        wanted = done + chosen.randint(1, max(1, 2 * len(undisturbed) // KILLS - 1))
        while process.poll() is None and logged_events(out) < min(wanted, len(undisturbed)):
            time.sleep(0.01)
        time.sleep(chosen.random() * 0.05)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        before, done = done, count(out)
        assert done >= before
    assert argo("evaluate", killed_file, "--out", out, "--no-report").returncode == 0
    assert sorted(read_rows(out), key=lambda row: row.key) == undisturbed


def test_killed_workers_change_nothing_of_the_rows(killed_file, undisturbed, tmp_path):
    chosen, out = random.Random(100 + KILLS + FIRST_SEED), tmp_path / "out"
    process = begun(killed_file, out)
    killed, wanted = 0, 1
    while process.poll() is None and killed < KILLS:
        # Some rows between two kills, so that it ever comes to an end.
        if logged_events(out) >= wanted and (workers := processes_of(process.pid)):
            wanted = logged_events(out) + chosen.randint(1, max(1, len(undisturbed) // KILLS // 2))
            with suppress(ProcessLookupError):  # it has ended by itself meanwhile
                os.kill(chosen.choice(workers), signal.SIGKILL)
                killed += 1
        time.sleep(0.01)
    assert process.wait(300) == 0
    assert killed == KILLS
    assert sorted(read_rows(out), key=lambda row: row.key) == undisturbed


def count(out: Path) -> int:
    """Read the rows on disk and return how many there are."""
    try:
        return len(read_rows(out))
    except NotFound:  # yet
        return 0


def logged_events(out: Path) -> int:
    """Return how many rows are on disk while an evaluation is under way, without reading them."""
    try:
        lines = (out / LOG).read_bytes().count(b"\n")
    except FileNotFoundError:  # yet
        return 0
    return lines or count(out)  # they have been moved


def test_no_worker_is_left_behind(long_file, tmp_path):
    process = begun(long_file, tmp_path / "out")
    while logged_events(tmp_path / "out") < 3:
        time.sleep(0.02)
    assert processes_of(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    deadline = time.monotonic() + 30
    while processes_of(process.pid) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not processes_of(process.pid)


def test_ctrl_c_keeps_the_rows(argo, long_file, tmp_path):
    out = tmp_path / "out"
    process = begun(long_file, out, subprocess.PIPE)
    while logged_events(out) < 3:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    _, told = process.communicate(timeout=60)
    assert process.returncode == 130
    kept = count(out)
    assert f"argo: interrupted; {kept} runs are stored in {out}" in told
    assert kept >= 3
    assert argo("evaluate", long_file, "--out", out, "--no-report").returncode == 0
    assert count(out) == 120
