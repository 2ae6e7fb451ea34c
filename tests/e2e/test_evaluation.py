"""`argo evaluate` from a shell: files, wrong input, kills, and repeated runs that failed."""

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
from argo_env.evaluation.store import LOG, RowStore, read_rows
from argo_env.files.checked_lines import parse_lines
from tests.conftest import FIRST_SEED, examples
from tests.e2e.conftest import ROOT, read_run_record, start_argo
from tests.e2e.test_errors import require_refusal

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


def write_evaluation(folder: Path, last: int = 4) -> Path:
    """Write an evaluation with the seeds from 0 to `last` into a folder; return its file."""
    (folder / "stop.yaml").write_text(STOP)
    path = folder / "evaluation.yaml"
    shutil.copy(ROOT / MISSION, folder / "mission_1.txt")
    path.write_text(FILE.format(mission="mission_1.txt", last=last))
    return path


@pytest.fixture(scope="module", autouse=True)
def cached_paths(argo) -> None:
    """Find the paths of the mission once for all commands and their workers."""
    argo.drive(ROOT / MISSION, 1, 2)


@pytest.fixture
def file(tmp_path) -> Path:
    return write_evaluation(tmp_path)


@pytest.fixture(scope="module")
def evaluated(argo, tmp_path_factory) -> tuple[Path, str]:
    """Return the folder of an evaluation and the output of the command."""
    folder = tmp_path_factory.mktemp("evaluated")
    result = argo("evaluate", write_evaluation(folder), "--out", folder / "out", status=0)
    return folder / "out", result.stdout


@pytest.fixture
def out(evaluated, tmp_path) -> Path:
    """Return the folder of a finished evaluation of `file`."""
    return shutil.copytree(evaluated[0], tmp_path / "out")


def test_a_file_is_evaluated_and_a_failed_run_is_repeated(argo, file, tmp_path):
    out = tmp_path / "out"
    result = argo("evaluate", file, "--out", out, "--workers", "2", status=0)
    assert "5 of 10 runs did not succeed" in result.stdout
    assert "stop" in result.stdout
    open_to_others = [path for path in out.rglob("*") if path.stat().st_mode & 0o077]
    assert not open_to_others
    assert {path.name for path in out.iterdir()} >= {"parts", "failing", "report.html"}
    rows = read_rows(out)
    assert len(rows) == 10
    failed = [row for row in rows if not row.success]
    assert {row.faults for row in failed} == {"stop"}
    spec = out / "failing" / f"{failed[0].key}.json"
    assert f"argo run {spec}" in result.stdout
    argo("run", spec, "--report", tmp_path / "alone", status=1)
    record = read_run_record(tmp_path / "alone")
    assert (record.result.duration, record.seed) == (failed[0].duration, failed[0].seed)
    assert "which sets --seed itself" in require_refusal(argo("run", spec, "--seed", "3"))


def test_a_finished_evaluation_prints_the_same_results_again(argo, file, evaluated, out):
    again = argo("evaluate", file, "--out", out, status=0)
    assert again.stdout == evaluated[1].replace(str(evaluated[0]), str(out))


def test_requirements_determine_the_exit_status(argo, tmp_path):
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
    result = argo("evaluate", "--compare", out, other, status=0)
    assert "No difference is shown." in result.stdout


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
        ((MISSION, "--compare", "here"), "leave the missions out"),
    ],
)
def test_wrong_input_gets_one_message(argo, tmp_path, arguments, message):
    assert message in require_refusal(argo("evaluate", *arguments, "--out", tmp_path / "out"))


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
def test_errors_in_an_evaluation_file_name_the_place(argo, tmp_path, text, message):
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    errors = require_refusal(argo("evaluate", path, "--out", tmp_path / "out"))
    assert "wrong.yaml:" in errors
    assert message in errors
    assert not (tmp_path / "out").exists()


def test_code_in_a_file_is_run_only_if_the_file_is_trusted(argo, tmp_path):
    path = write_evaluation(tmp_path, 0)
    path.write_text(path.read_text() + "policies: ['os:getcwd']\n")
    errors = require_refusal(argo("evaluate", path, "--out", tmp_path / "out"))
    assert "the policy `os:getcwd` is code" in errors
    assert errors.rstrip().endswith("(--trust)")
    trusted = require_refusal(argo("evaluate", path, "--trust", "--out", tmp_path / "out"))
    assert "policy `os:getcwd`: TypeError" in trusted


def test_a_file_outside_of_the_folder_is_refused_unless_the_file_is_trusted(argo, tmp_path):
    path = write_evaluation(tmp_path, 0)
    (tmp_path / "below").mkdir()
    path = path.rename(tmp_path / "below" / path.name)
    text = path.read_text().replace("stop.yaml", "../stop.yaml")
    path.write_text(text.replace("mission_1.txt", "../mission_1.txt"))
    errors = require_refusal(argo("evaluate", path, "--out", tmp_path / "out"))
    assert "`../mission_1.txt` is outside of the folder of the file" in errors
    argo("evaluate", path, "--trust", "--out", tmp_path / "out", status=0)
    path.write_text(path.read_text() + "robots: ['../../x']\n")
    robot = require_refusal(argo("evaluate", path, "--trust", "--out", tmp_path / "other"))
    assert "no robot `../../x`; there are: tracker" in robot


def test_another_evaluation_is_not_overwritten(argo, out):
    message = require_refusal(argo("evaluate", MISSION, *AREAS, "--seeds", "0..1", "--out", out))
    assert "has another evaluation" in message
    assert "--force" in message


def test_options_that_belong_in_the_file_are_refused(argo, file, tmp_path):
    message = require_refusal(
        argo("evaluate", file, "--out", tmp_path / "out", "--drive", "kinematic")
    )
    assert "write --drive into the file" in message


def test_damaged_rows_are_told_and_repeated(argo, file, out):
    rows = read_rows(out)
    shutil.rmtree(out / "parts")
    with RowStore(out) as store:
        for row in rows:
            store.add_if_new(row)
    lines = (out / LOG).read_bytes().splitlines(keepends=True)
    lines[2] = lines[2].replace(b"umad", b"amud")
    (out / LOG).write_bytes(b"".join(lines))
    refusal = require_refusal(argo("evaluate", "--compare", out, out))
    assert f"{out / LOG}: damaged in line 3: evaluate again into this folder" in refusal
    result = argo("evaluate", file, "--out", out, status=0)
    assert f"{out / LOG}: damaged in line 3: the lost runs are repeated" in result.stderr
    assert sorted(read_rows(out), key=lambda row: row.key) == sorted(rows, key=lambda row: row.key)


def test_changed_faults_make_another_evaluation(argo, file, out, tmp_path):
    (tmp_path / "stop.yaml").write_text(STOP.replace("at: 30", "at: 40"))
    assert "has another evaluation" in require_refusal(argo("evaluate", file, "--out", out))
    assert argo("evaluate", file, "--out", out, "--force").returncode == 0
    began = {one.began for row in read_rows(out) for one in row.detections}
    assert began == {40.0}


def test_a_replaced_evaluation_keeps_only_rows_that_still_fit(argo, file, out):
    before = {row.key: row for row in read_rows(out)}
    assert len(list((out / "failing").iterdir())) == 5
    assert len(list((out / "parts").glob("*.parquet"))) == 1
    file.write_text(FILE.format(mission=ROOT / MISSION, last=2).replace("none, ", ""))
    result = argo("evaluate", file, "--out", out, "--force", "--trust")
    assert "3 of 3 runs" in result.stdout
    after = {row.key: row for row in read_rows(out)}
    assert len(after) == 3
    assert after.items() < before.items()
    assert {path.stem for path in (out / "failing").iterdir()} == set(after)


def test_files_of_others_are_not_overwritten(argo, file, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("somebody's own")
    assert "report.html already exists" in require_refusal(argo("evaluate", file, "--out", out))
    assert (out / "report.html").read_text() == "somebody's own"
    assert argo("evaluate", file, "--out", out, "--force").returncode == 0
    assert argo("evaluate", file, "--out", out).returncode == 0
    assert argo("evaluate", "--compare", out, out).returncode == 0
    again = require_refusal(argo("evaluate", "--compare", out, out))
    assert "comparison.html already exists" in again
    assert argo("evaluate", "--compare", out, out, "--out", tmp_path / "other").returncode == 0
    assert (tmp_path / "other" / "comparison.html").exists()


@pytest.mark.parametrize("name", ["parts", "failing", "rows.log", "evaluation.json", "report.html"])
def test_obstructing_paths_are_named_before_anything_runs(argo, file, tmp_path, name):
    out = tmp_path / "out"
    out.mkdir()
    if name in ("parts", "failing"):
        (out / name).touch()
    else:
        (out / name).mkdir()
    result = argo("evaluate", file, "--out", out, "--force")
    assert str(out / name) in require_refusal(result)
    assert result.stdout == ""


def test_plans_of_one_evaluation_are_compared_by_name(argo, tmp_path):
    out = tmp_path / "out"
    options = ("--seeds", "0..9", "--out", out, "--policy", "as written", "--policy", "optimised")
    assert argo("evaluate", MISSION, *AREAS, *options).returncode == 0
    unclear = require_refusal(argo("evaluate", "--compare", out, out))
    assert "mission_1, as written; mission_1, optimised (--plan)" in unclear
    named = ("--plan", "mission_1, as written", "--plan", "mission_1, optimised")
    result = argo("evaluate", "--compare", out, out, *named, status=0)
    assert "A: mission_1, as written" in result.stdout
    for arguments in ((), named):  # of one folder, two plans are compared, named or not
        alone = argo("evaluate", "--compare", out, *arguments, "--no-report", status=0)
        assert alone.stdout.partition("Report:")[0] == result.stdout.partition("Report:")[0]
    single = argo("evaluate", "--compare", out, *named[:2], "--no-report")
    assert "name two of its plans by --plan, or a second evaluation" in require_refusal(single)
    wrong = argo("evaluate", "--compare", out, out, "--plan", "mission_2", "--no-report")
    assert "no plan `mission_2`" in wrong.stderr


def test_a_policy_may_stand_beside_the_file(argo, tmp_path):
    for folder, order in (("one", "mission"), ("other", "1 / 0")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "orders.py").write_text(f"def kept(mission, site): return {order}\n")
        (tmp_path / folder / "file.yaml").write_text(
            f"missions: [{{file: {ROOT / MISSION}, start_area: 1, end_area: 2}}]\n"
            "policies: [orders:kept]\nseeds: 0..1\n"
        )
    (one, out), (two, other_out) = (
        (tmp_path / name / "file.yaml", tmp_path / f"{name}_out") for name in ("one", "other")
    )
    result = argo("evaluate", one, "--trust", "--out", out)
    assert result.returncode == 0, result.stderr
    other = argo("evaluate", two, "--trust", "--out", other_out)
    assert "policy `orders:kept`: ZeroDivisionError" in require_refusal(other)


def test_an_evaluation_in_which_no_run_can_be_carried_out_fails(argo, file, tmp_path):
    text = file.read_text().replace("speed: [0.8, 1.0]", "ahead: 0.7")
    file.write_text(text.replace("seeds: 0..4", "seeds: 0..1").replace(", stop.yaml", ""))
    result = argo("evaluate", file, "--out", tmp_path / "out", status=1)
    assert "no run could be carried out" in result.stderr
    assert "are in no rate" in result.stdout


def test_failing_runs_name_their_plan(argo, file, tmp_path):
    file.write_text(file.read_text() + "policies: [as written, optimised]\n")
    result = argo("evaluate", file, "--out", tmp_path / "out")
    assert "  mission 1, optimised, seed 0, stop: " in result.stdout


def test_more_seeds_are_added_to_the_stored_rows(argo, file, out):
    before = {row.key for row in read_rows(out)}
    file.write_text(FILE.format(mission=ROOT / MISSION, last=6))
    assert argo("evaluate", file, "--out", out, "--trust").returncode == 0
    after = {row.key for row in read_rows(out)}
    assert before < after
    assert len(after) == 14


def start_evaluate(
    file: Path, out: Path, stderr: int = subprocess.DEVNULL
) -> subprocess.Popen[str]:
    options = {"stdout": subprocess.DEVNULL, "stderr": stderr, "start_new_session": True}
    arguments = ("evaluate", file, "--out", out, "--workers", 2, "--no-report")
    return start_argo(*arguments, cwd=ROOT, **options)


def other_processes(session: int) -> list[int]:
    """Return the ids of a session's processes without its leader and resource trackers."""
    ids = []
    for name in os.listdir("/proc"):
        if not name.isdecimal() or int(name) == session:
            continue
        try:
            stat = Path(f"/proc/{name}/stat").read_text()
            line = Path(f"/proc/{name}/cmdline").read_bytes()
        except OSError:
            continue
        if int(stat.rpartition(")")[2].split()[3]) == session and b"resource_tracker" not in line:
            ids.append(int(name))
    return ids


@pytest.fixture(scope="module")
def long_file(tmp_path_factory) -> Path:
    return write_evaluation(tmp_path_factory.mktemp("long"), last=59)


KILLS = examples(20)
WORLDS = max(30, 3 * KILLS)
"""enough for some rows between two kills and after the last one"""


@pytest.fixture(scope="module")
def killed_file(tmp_path_factory) -> Path:
    return write_evaluation(tmp_path_factory.mktemp("killed"), last=WORLDS - 1)


@pytest.fixture(scope="module")
def undisturbed(argo, killed_file, tmp_path_factory):
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    assert argo("evaluate", killed_file, "--out", out, "--no-report").returncode == 0
    return sorted(read_rows(out), key=lambda row: row.key)


def test_a_killed_evaluation_ends_with_the_rows_of_an_undisturbed_one(
    argo, killed_file, undisturbed, tmp_path
):
    """The command gets SIGKILL at random moments; no stored row is lost or doubled."""
    chosen, out = random.Random(KILLS + FIRST_SEED), tmp_path / "out"
    done = 0
    for _ in range(KILLS):
        process = start_evaluate(killed_file, out)
        wanted = done + chosen.randint(1, max(1, 2 * len(undisturbed) // KILLS - 1))
        while process.poll() is None and count_logged_rows(out) < min(wanted, len(undisturbed)):
            time.sleep(0.01)
        time.sleep(chosen.random() * 0.05)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        before, done = done, count_rows(out)
        assert done >= before
    assert argo("evaluate", killed_file, "--out", out, "--no-report").returncode == 0
    assert sorted(read_rows(out), key=lambda row: row.key) == undisturbed


def test_killed_workers_do_not_change_the_rows(killed_file, undisturbed, tmp_path):
    chosen, out = random.Random(100 + KILLS + FIRST_SEED), tmp_path / "out"
    process = start_evaluate(killed_file, out)
    killed, wanted = 0, 1
    while process.poll() is None and killed < KILLS:
        # Some rows between two kills, or the evaluation would never end.
        if count_logged_rows(out) >= wanted and (workers := other_processes(process.pid)):
            wanted = count_logged_rows(out) + chosen.randint(
                1, max(1, len(undisturbed) // KILLS // 2)
            )
            with suppress(ProcessLookupError):  # it has ended by itself meanwhile
                os.kill(chosen.choice(workers), signal.SIGKILL)
                killed += 1
        time.sleep(0.01)
    assert process.wait(300) == 0
    assert killed  # on a fast machine all runs end before the last kill
    assert sorted(read_rows(out), key=lambda row: row.key) == undisturbed


def count_rows(out: Path) -> int:
    """Read the rows on disk and return their number, 0 if there are none yet."""
    try:
        return len(read_rows(out))
    except NotFound:
        return 0


def count_logged_rows(out: Path) -> int:
    """Return the number of rows on disk during an evaluation, if possible without reading them."""
    try:
        logged = parse_lines((out / LOG).read_bytes()).objects
    except FileNotFoundError:
        return 0
    return len(logged) or count_rows(out)  # the rows may have been moved from the log


def test_no_worker_is_left_behind(long_file, tmp_path):
    process = start_evaluate(long_file, tmp_path / "out")
    while count_logged_rows(tmp_path / "out") < 3:
        time.sleep(0.02)
    assert other_processes(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    deadline = time.monotonic() + 30
    while other_processes(process.pid) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not other_processes(process.pid)


def test_ctrl_c_keeps_the_rows(argo, long_file, tmp_path):
    out = tmp_path / "out"
    process = start_evaluate(long_file, out, subprocess.PIPE)
    while count_logged_rows(out) < 3:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    stored = count_rows(out)
    assert f"argo: interrupted; {stored} runs stored in {out}" in errors
    assert stored >= 3
    assert argo("evaluate", long_file, "--out", out, "--no-report").returncode == 0
    assert count_rows(out) == 120


@pytest.mark.parametrize("delay", [0, 0.4])
def test_ctrl_c_while_workers_start(long_file: Path, tmp_path: Path, delay: float) -> None:
    process = start_evaluate(long_file, tmp_path / "out", subprocess.PIPE)
    while not other_processes(process.pid):
        time.sleep(0.005)
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert errors.splitlines()[-1].startswith("argo: interrupted")
    assert "Traceback" not in errors
