"""The example package that extends Argo, installed and used; and packages with faults.

Each is installed into a folder of its own, which is then on the path of the commands.
"""

import json
import os
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import httpx
import pytest

from argo_env.evaluation.folder import read_rows
from tests.e2e.conftest import Argo, read_run_record, start_argo
from tests.e2e.test_service import ServiceProcess

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "extension"
ANY_ORDER = ROOT / "scenarios" / "umad" / "missions" / "any_order.txt"

MISSION = """\
Mission Extended
Maximum mission total duration: 30'
1. Set the starting point in starting area 1.
2. Check #1.
3. Check #4.
"""


def install_fake(
    folder: Path, name: str, points: Mapping[str, Mapping[str, str]], code: str
) -> None:
    """Write a package, as `pip install --target` would, with these entry points by group."""
    (folder / f"{name.replace('-', '_')}_code.py").write_text(textwrap.dedent(code))
    info = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    lines = []
    for group, entries in points.items():
        lines += [f"[{group}]", *(f"{key} = {value}" for key, value in entries.items()), ""]
    (info / "entry_points.txt").write_text("\n".join(lines))


@pytest.fixture(scope="session")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the example package into a folder, and return the folder."""
    folder = tmp_path_factory.mktemp("extension")
    uv = Path(sys.executable).with_name("uv")
    install = (uv, "pip", "install", "--quiet", "--no-deps", "--no-build-isolation")
    into = ("--python", sys.executable, "--target", folder)
    subprocess.run([*install, *into, EXAMPLE], check=True)
    return folder


@pytest.fixture(scope="session")
def broken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install two packages that do all that a package must not do, and return their folder."""
    folder = tmp_path_factory.mktemp("broken")
    module = "bad_package_code"
    install_fake(
        folder,
        "bad-package",
        {
            "argo.sensors": {
                "broken": "bad_package_missing:make",
                "ideal": f"{module}:number",
                "number": f"{module}:number",
                "malformed": "not a module",
                "two words": f"{module}:number",
            },
            "argo.drives": {"route": f"{module}:number", "fails": f"{module}:fail"},
            "argo.exporters": {
                "scxml": f"{module}:number",
                "btcpp": f"{module}:number",
                "checklist": f"{module}:number",
                "exits": "bad_package_exits:exporter",
            },
            "argo.faults": {"gas_leak": f"{module}:Leak", "leak": f"{module}:Leak"},
            "argo.solvers": {"liar": f"{module}:LIAR", "fails": f"{module}:FAILS"},
            "argo.policies": {"fails": f"{module}:fail"},
            "argo.responses": {"abort": f"{module}:fail", "fails": f"{module}:fail"},
        },
        """
        from argo_compiler.route import Tour

        number = 1

        def fail(*arguments):
            raise ZeroDivisionError("a fault of the package")

        class Leak:
            kind = "leak"

        class Fails:
            name = "fails"

            def supports(self, problem):
                return True

            def solve(self, search):
                fail()

        class Liar(Fails):
            name = "liar"

            def solve(self, search):
                search.offer_tour(Tour(tuple(range(search.problem.size))))
                search.report_bounds(bound=10**9)
                search.report_infeasible()

        FAILS, LIAR = Fails(), Liar()
        """,
    )
    (folder / "bad_package_exits.py").write_text("raise SystemExit('no licence')\n")
    return folder


def path_with(*folders: Path) -> str:
    """Return the search path for modules with these folders on it."""
    return os.pathsep.join(filter(None, (*map(str, folders), os.environ.get("PYTHONPATH"))))


def run_python(folder: Path, *arguments: str) -> str:
    """Run Python with a folder on its path, and return its output."""
    environment = {**os.environ, "PYTHONPATH": path_with(folder), "COLUMNS": "120"}
    command = [sys.executable, *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


Extended = Callable[..., "subprocess.CompletedProcess[str]"]


def command_with(*folders: Path) -> Extended:
    """Return a function that runs `argo` with these folders on its path."""
    environment = {**os.environ, "PYTHONPATH": path_with(*folders), "COLUMNS": "120"}

    def run(*arguments: object, **options: object) -> "subprocess.CompletedProcess[str]":
        status = options.pop("status", 0)
        process = start_argo(*arguments, env=environment, **options)
        output, errors = process.communicate(timeout=120)
        assert process.returncode == status, output + errors
        assert "Traceback" not in errors, errors
        return subprocess.CompletedProcess(arguments, process.returncode, output, errors)

    return run


@pytest.fixture
def extended(example: Path) -> Extended:
    return command_with(example)


@pytest.fixture
def mission(tmp_path: Path) -> Path:
    path = tmp_path / "mission.txt"
    path.write_text(MISSION)
    return path


class TestExample:
    def test_the_doctor_lists_each_extension_with_its_origin(self, extended: Extended) -> None:
        output = extended("doctor").stdout
        for kind, name in (
            ("format", "checklist"),
            ("sensor", "haze"),
            ("drive", "cautious"),
            ("fault", "fogged_lens"),
            ("route solver", "random-restarts"),
            ("policy", "bottom-up"),
            ("response", "evacuate"),
        ):
            assert f"{kind} `{name}` of argo-example 1.0.0: works" in output

    def test_the_exporter(self, extended: Extended, mission: Path, tmp_path: Path) -> None:
        assert "checklist" in extended("export", "--help").stdout
        extended("export", mission, "--to", "checklist", "-o", tmp_path / "list.csv")
        rows = (tmp_path / "list.csv").read_text().splitlines()
        assert rows[0].startswith("task,checkpoint,name,x in m")
        assert [row.split(",")[1] for row in rows[1:]] == ["1", "4"]

    @pytest.mark.long
    @pytest.mark.physics
    def test_drive_sensor_and_fault_in_a_run(
        self, extended: Extended, mission: Path, tmp_path: Path
    ) -> None:
        faults = tmp_path / "faults.yaml"
        faults.write_text("faults:\n  - {kind: fogged_lens, at: 0, density: 0.3}\n")
        extended("run", mission, "--report", tmp_path / "usual")
        arguments = ("--drive", "cautious", "--sensor", "haze", "--faults", faults)
        extended("run", mission, *arguments, "--report", tmp_path / "extended")
        usual, slow = (
            json.loads((tmp_path / name / "report.json").read_bytes())
            for name in ("usual", "extended")
        )
        assert (slow["drive"], slow["sensor"]) == ("cautious", "haze")
        assert slow["result"]["distance"] == pytest.approx(usual["result"]["distance"], rel=0.02)
        assert slow["result"]["duration"] > 1.2 * usual["result"]["duration"]
        assert all(reading["confidence"] < 1 for reading in slow["readings"])
        assert [(fault["kind"], fault["density"]) for fault in slow["faults"]] == [
            ("fogged_lens", 0.3)
        ]
        found = {(anomaly["kind"], anomaly["source"]) for anomaly in slow["anomalies"]}
        assert ("dysfunction", "camera") in found

    def test_wrong_fields_of_a_fault_are_reported_with_their_line(
        self, extended: Extended, mission: Path, tmp_path: Path
    ) -> None:
        faults = tmp_path / "faults.yaml"
        faults.write_text("faults:\n  - kind: fogged_lens\n    density: 2\n")
        errors = extended("run", mission, "--faults", faults, status=2).stderr
        assert "faults.yaml:3" in errors
        assert "`density` has to be at most 1" in errors

    @pytest.mark.long
    @pytest.mark.physics
    def test_a_run_is_resumed_only_with_the_same_package(
        self, argo: Argo, extended: Extended, mission: Path, tmp_path: Path
    ) -> None:
        journal = tmp_path / "run.journal"
        extended("run", mission, "--drive", "cautious", "--journal", journal)
        lines = journal.read_bytes().splitlines(keepends=True)
        journal.write_bytes(b"".join(lines[: len(lines) // 2]))
        refused = argo("resume", journal, status=2)
        assert "argo-example 1.0.0 (was used, is absent)" in refused.stderr
        extended("resume", journal)

    def test_the_solver(self, extended: Extended) -> None:
        usual, extra = (
            extended("route", ANY_ORDER, "--time-limit", 2, "--verify", *options).stdout
            for options in ((), ("--solver", "random-restarts"))
        )
        order = next(line for line in usual.splitlines() if line.startswith("Order"))
        assert order in extra

    @pytest.mark.long
    @pytest.mark.physics
    def test_the_policy_in_an_evaluation(self, extended: Extended, tmp_path: Path) -> None:
        head, _, tasks = ANY_ORDER.read_text().partition("1. ")
        few = [line for line in f"1. {tasks}".splitlines() if line[0] in "12"]
        (tmp_path / "few.txt").write_text("\n".join([head, *few]))
        faults = tmp_path / "fog.yaml"
        faults.write_text("faults: [{kind: fogged_lens, at: 0}]\n")
        evaluation = tmp_path / "evaluation.yaml"
        evaluation.write_text(
            "missions: [few.txt]\n"
            "drives: [cautious]\nsensors: [haze]\npolicies: [as written, bottom-up]\n"
            "faults: [none, fog.yaml]\nseeds: 0..0\n"
        )
        folder = tmp_path / "out"
        extended("evaluate", evaluation, "--out", folder, "--workers", 1)
        rows = read_rows(folder)
        assert {(row.plan.drive, row.plan.sensor) for row in rows} == {("cautious", "haze")}
        assert {row.plan.policy for row in rows} == {"as written", "bottom-up"}
        assert {row.faults for row in rows} == {"none", "fog"}

    def test_the_policy_in_episodes(self, example: Path) -> None:
        arguments = "--family random-20-v1 --instances 3 --policy bottom-up nearest-neighbour"
        output = run_python(example, "-m", "baselines.evaluate", *arguments.split())
        rows = [line.split("│") for line in output.splitlines() if "│" in line]
        found = {row[2].strip(): row[4:] for row in rows}
        # Both choose the nearest checkpoint.
        assert found["bottom-up"] == found["nearest-neighbour"]

    @pytest.mark.physics
    def test_drive_and_fault_in_an_environment(self, example: Path) -> None:
        code = """
            import gymnasium, argo_env
            env = gymnasium.make("argo/Inspect-v0", scenario="darmstadt", drive="cautious")
            fog = [{"kind": "fogged_lens", "at": 0, "density": 0.5}]
            env.reset(seed=1, options={"faults": fog})
            env.step(int(env.unwrapped.action_masks().argmax()))
            record = env.unwrapped.record()
            print(record.drive, record.faults[0].kind)
            """
        assert run_python(example, "-c", textwrap.dedent(code)).endswith("cautious fogged_lens\n")

    def test_the_response(
        self, extended: Extended, argo: Argo, mission: Path, tmp_path: Path
    ) -> None:
        path = tmp_path / "mission.json"
        extended("import", mission, "-o", path)
        data = json.loads(path.read_bytes())
        data["reactions"] = [{"event": "gas_leak", "response": "evacuate", "hold_limit": 600.0}]
        path.write_text(json.dumps(data))
        extended("check", path)
        assert "return to the dock" in extended("explain", path).stdout
        extended("format", path, "-o", tmp_path / "again.txt")
        assert "10 min" in (tmp_path / "again.txt").read_text()
        refused = argo("check", path, status=2)
        assert "reactions[0].response" in refused.stdout


class TestFaultyPackages:
    """Packages that raise, or that take names that are taken, beside the example package."""

    @pytest.fixture
    def hampered(self, example: Path, broken: Path) -> Extended:
        return command_with(broken, example)

    def test_the_doctor_names_them(self, hampered: Extended) -> None:
        output = hampered("doctor").stdout
        for line in (
            "sensor `broken` of bad-package 1.0: can't be imported: ModuleNotFoundError: No module "
            "named 'bad_package_missing'",
            "sensor `ideal` of bad-package 1.0: is not used: Argo has a sensor of that name",
            "sensor `number` of bad-package 1.0: is no function",
            "sensor `malformed` of bad-package 1.0: can't be imported",
            "sensor `two words` of bad-package 1.0: is not used: a name has",
            "drive `route` of bad-package 1.0: is not used: Argo has a drive of that name",
            "format `scxml` of bad-package 1.0: is not used: Argo has a format of that name",
            "format `btcpp` of bad-package 1.0: is not used: argo-mission ",
            "format `checklist` of bad-package 1.0: is not used: argo-example 1.0.0 has a format",
            "format `exits` of bad-package 1.0: can't be imported: SystemExit: no licence",
            "fault `gas_leak` of bad-package 1.0: is not used: Argo has a fault of that name",
            "fault `leak` of bad-package 1.0: is no subclass of",
            "response `abort` of bad-package 1.0: is not used: Argo has a response of that name",
            "sensor `haze` of argo-example 1.0.0: works",
        ):
            assert line in output

    def test_names_of_argo_and_of_other_packages_stay(
        self, hampered: Extended, mission: Path, tmp_path: Path
    ) -> None:
        for name, start in (("scxml", "<?xml"), ("btcpp", "<?xml"), ("checklist", "task,")):
            hampered("export", mission, "--to", name, "-o", tmp_path / name)
            assert (tmp_path / name).read_text().startswith(start)
        hampered("run", mission, "--drive", "route", "--report", tmp_path / "report")
        assert read_run_record(tmp_path / "report").sensor == "ideal"

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            pytest.param(
                ("run", "--sensor", "broken"),
                "the sensor `broken` of bad-package 1.0 can't be",
                marks=pytest.mark.physics,
            ),
            pytest.param(
                ("run", "--drive", "fails"),
                "bad-package 1.0 has failed: ZeroDivisionError: a fault",
                marks=pytest.mark.physics,
            ),
            (("export", "--to", "exits", "-o", "-"), "the format `exits` of bad-package 1.0 can't"),
            (("evaluate", "--policy", "fails"), "the policy `fails` plays episodes"),
            (("route", "--solver", "nobody"), "no route solver `nobody`"),
        ],
    )
    def test_who_asks_for_one_gets_one_line(
        self, hampered: Extended, mission: Path, arguments: tuple[str, ...], message: str
    ) -> None:
        command, *options = arguments
        errors = hampered(command, mission, *options, status=2, cwd=mission.parent).stderr
        assert message in errors.splitlines()[-1]
        assert errors.splitlines()[-1].startswith("argo: ")

    def test_a_response_that_raises_is_an_error_of_the_mission(
        self, hampered: Extended, mission: Path, tmp_path: Path
    ) -> None:
        path = tmp_path / "mission.json"
        hampered("import", mission, "-o", path)
        data = json.loads(path.read_bytes())
        data["reactions"] = [{"event": "gas_leak", "response": "fails"}]
        path.write_text(json.dumps(data))
        errors = hampered("check", path, status=2).stdout
        assert "response `fails` of bad-package 1.0 has failed (ZeroDivisionError" in errors


@pytest.fixture
def service(
    example: Path, broken: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[httpx.Client]:
    """Start a service with all of these packages, and return a client."""
    monkeypatch.setenv("PYTHONPATH", path_with(example, broken))
    process = ServiceProcess(tmp_path / "missions")
    process.begin()
    with process.client() as client:
        yield client
    process.process.kill()
    process.process.communicate()


@pytest.mark.long
@pytest.mark.physics
def test_the_service(service: httpx.Client) -> None:
    listed = service.get("/api/service").json()["extensions"]
    assert {one["name"] for one in listed} == {
        "checklist", "haze", "cautious", "fails", "liar", "fogged_lens", "random-restarts",
        "bottom-up", "evacuate",
    }  # fmt: skip
    assert all(one["problem"] is None for one in listed)
    made = service.post(
        "/api/imports", params={"filename": "m.txt", "start_area": 1}, content=MISSION
    )
    at = made.headers["location"]
    assert service.get(f"{at}/export/checklist").text.startswith("task,checkpoint,name")
    assert service.get(f"{at}/export/nothing").json()["code"] == "not-found"

    reaction = {"event": "gas_leak", "response": "evacuate"}
    edit = {"kind": "add_reaction", "reaction": reaction}
    body = {"kind": "edit", "id": "k1", "edits": [edit]}
    assert service.post(f"{at}/commands", json=body, headers=ANY).status_code == 200
    (added,) = service.get(at).json()["mission"]["reactions"]
    assert (added["response"], added["until"], added["priority"]) == ("return", "all_clear", 95)

    refused = service.post(f"{at}/orders", json={"solvers": ["nobody"]})
    assert "no installed package offers the solver `nobody`" in refused.json()["detail"]
    search = {"time_limit": 1, "solvers": ["random-restarts", "fails"]}
    job = service.post(f"{at}/orders", json=search).headers["location"]
    assert wait_while(service, job, state="running")["state"] == "done"

    run = {"drive": "cautious", "sensor": "haze", "faults": [{"kind": "fogged_lens", "at": 0}]}
    begun = service.post(f"{at}/runs", json=run | {"speed": 1000.0}, headers=ANY)
    state = wait_for_end(service, begun)
    assert (state["drive"], state["status"]) == ("cautious", "ended"), state
    assert state["sensor"] == "haze"

    # A package that fails ends its own run, and nothing else.
    state = wait_for_end(service, service.post(f"{at}/runs", json={"drive": "fails"}, headers=ANY))
    problem = "the package bad-package 1.0 has failed: ZeroDivisionError: a fault of the package"
    assert (state["status"], state["problem"]) == ("ended", problem)
    assert service.get("/api/service").status_code == 200


ANY = {"if-match": "*"}


def wait_for_end(service: httpx.Client, begun: httpx.Response) -> dict[str, Any]:
    """Return the state of a run when it has ended."""
    return wait_while(service, begun.headers["location"], status=("preparing", "running"))


def wait_while(service: httpx.Client, address: str, **fields: Any) -> dict[str, Any]:
    """Return what is at an address as soon as its field has another value than the given ones."""
    ((field, values),) = fields.items()
    while True:
        state: dict[str, Any] = service.get(address).json()
        if state[field] not in values:
            return state
        time.sleep(0.05)
