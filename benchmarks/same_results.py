"""Comparison of all results with those of another checkout, byte for byte.

    git worktree add ../before COMMIT
    python -m benchmarks.same_results ../before                      # all groups
    python -m benchmarks.same_results ../before plans kinematic      # some groups
    python -m benchmarks.same_results ../before --only protocol_2    # results with this name
    python -m benchmarks.same_results --write digests.txt            # store this checkout's digests
    python -m benchmarks.same_results digests.txt                    # compare with stored digests
    python3.13 -m benchmarks.same_results digests.txt                # likewise, on another Python
    python -m benchmarks.same_results ../before --without-prose      # after a change of words

`plans`, `routes` and `journals` run the commands of `argo` as a user would: they read, check,
explain, compile and export scripts and missions, search for routes, and record and resume runs.
They compare all files that a command writes, its exit status and its output, without wall-clock
times. `route`, `kinematic` and `tracked` run the shipped missions and each shipped file of faults
with the drive of that name, and compare the records. `drive` takes random actions in Drive-v0, and
compares all returned values and the states.

Each checkout runs in a process of its own, which prints a digest of each result. The command prints
each result that differs; its exit status is then 1.

With `--without-prose`, JSON files are compared without texts of several words, and of all other
text files only the numbers are compared. So keys, values, ids and structure still count.
"""

import argparse
import hashlib
import importlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from itertools import zip_longest
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
UMAD = ROOT / "scenarios" / "umad"
COMMANDS = ("plans", "routes", "journals")
GROUPS = (*COMMANDS, "route", "kinematic", "tracked", "drive")
SEEDS = {"route": 4, "kinematic": 4, "tracked": 1}
EXPORTS = ("scxml", "btcpp", "flexbe", "ros", "isar", "mermaid", "dot")


def run_records(drive: str) -> Iterator[tuple[str, bytes]]:
    """Yield the name of each run with a drive, and its record as JSON."""
    from argo_env.planning import open_site
    from argo_env.run.session import simulate
    from argo_env.run.spec import RunSpec
    from argo_planner.use_cases.importing import Upload, import_mission

    # Older checkouts have other names: `argo_env.faults.reading`, and no `logged_events`.
    is_new = find_spec("argo_env.faults.loading") is not None
    faults_module = "argo_env.faults.loading" if is_new else "argo_env.faults.reading"
    read_faults = importlib.import_module(faults_module).read_faults
    resume: Any = (300.0, {"kind": "resume"})

    site = open_site("umad").prepare()

    def mission(path: Path, *areas: int):
        return import_mission(Upload(path.name, path.read_bytes()), site, *areas).mission

    missions = UMAD / "missions"
    first = mission(missions / "mission_1.txt", 1, 2)
    cases = [("mission_1", first, (), "ideal"), ("mission_1", first, (), "camera")]
    cases.append(("protocol_3", mission(missions / "protocol_3.txt"), (), "ideal"))
    folder = UMAD / "faults"
    on_ground, upstairs = mission(folder / "ground.txt"), mission(folder / "upstairs.txt")
    for path in sorted(folder.glob("*.yaml")):
        faults = read_faults(path)
        cases.append((f"ground, {path.stem}", on_ground, faults, "ideal"))
        cases.append((f"upstairs, {path.stem}", upstairs, faults, "ideal"))
    for name, case_mission, faults, sensor in cases:
        if drive == "route" and (sensor != "ideal" or any(f.needs_world for f in faults)):
            continue
        for seed in range(SEEDS[drive]):
            spec = RunSpec(
                mission=case_mission,
                drive=drive,
                sensor=sensor,
                seed=seed,
                faults=faults,
                events=(resume,),
            )
            record = simulate(spec, site)
            counts = f"{len(record.contacts)} contacts, {len(record.anomalies)} anomalies"
            yield (
                f"{drive}: {name}, {sensor}, seed {seed}: {counts}",
                record.model_dump_json().encode(),
            )


def drive_episodes() -> Iterator[tuple[str, bytes]]:
    """Yield the name of each episode of Drive-v0, and all values that it returned, as text."""
    import gymnasium as gym
    import numpy as np

    import argo_env  # noqa: F401

    env = gym.make("argo/Drive-v0", disable_env_checker=True).unwrapped
    faults = [{"kind": "brick"}, {"kind": "missing_plate"}]
    for seed in range(8):
        observation, info = env.reset(
            seed=seed, options={"faults": faults} if seed % 4 == 3 else {}
        )
        values: list[object] = [observation, info]
        rng = np.random.default_rng(seed)
        bias = rng.uniform(-1.0, 1.0, 3)
        for _ in range(250):
            action = np.clip(bias + rng.uniform(-0.5, 0.5, 3), -1.0, 1.0).astype(np.float32)
            *returned, terminated, truncated, info = env.step(action)
            values += [*returned, terminated, truncated, info, env.pose, env.site.body.velocity]
            if terminated or truncated:
                break
        values.append(env.get_state())
        values.append(env.set_state(env.get_state()))
        with np.printoptions(floatmode="unique", threshold=sys.maxsize):
            yield f"drive: seed {seed}, {len(values)} values", repr(values).encode()


Case = tuple[str, Sequence[Sequence[str]]]
"""Name of a case, and its commands, which are run one after another in a new folder."""


def mission_cases() -> Iterator[Case]:
    """Yield the cases that read, check, explain, compile, export and rewrite missions."""
    areas = ("--start-area", "1", "--end-area", "2")
    for name in ("mission_1.txt", "protocol_2.txt", "protocol_3.txt", "any_order.txt"):
        options = areas if name in ("mission_1.txt", "any_order.txt") else ()
        source = f"missions/{name}"
        yield (
            name,
            (
                ("import", source, "-o", "mission.json", *options),
                ("explain", source, "--format", "json", *options),
                ("compile", "mission.json", "-o", "machine.json", "--mermaid", "machine.mmd"),
                ("format", "mission.json", "-o", "script.txt"),
                ("import", "script.txt", "-o", "again.json"),
                *(("export", "mission.json", "--to", to, "-o", f"as_{to}") for to in EXPORTS),
            ),
        )
    yield "rounds_and_windows", (("compile", "missions/rounds_and_windows.json", "-o", "m.json"),)
    scripts = sorted(path.name for path in (ROOT / "tests").glob("**/script/people/*.txt"))
    for name in scripts:
        check = ("check", f"people/{name}", "--format", "json")
        yield name, (check, ("import", f"people/{name}", "-o", "mission.json"))


def route_cases() -> Iterator[Case]:
    """Yield the cases that search for routes, which are proven well within the time limit."""
    base = ("route", "missions/any_order.txt", "--time-limit", "60", "-o", "new.json")
    for name, options in {
        "any order": (),
        "budget": ("--budget", "10min"),
        "budget, before": ("--budget", "15min", "--before", "14, 8"),
        "kept order": ("--budget", "8min", "--keep-order"),
        "no order": ("--before", "14, 8", "--before", "8, 14"),
        "verified, at risk": ("--budget", "12min", "--verify", "--risk", "cautious"),
        "robust": ("--robust", "--risk", "simulated"),
        "areas": ("--start-area", "1", "--end-area", "2"),
    }.items():
        yield name, ((*base, *options),)
    optimised = ("--optimise", "--drive", "route", "--report", "report")
    yield "optimised run", (("run", "missions/any_order.txt", *optimised),)


def journal_cases() -> Iterator[Case]:
    """Yield the cases that record runs in journals and reports, and resume interrupted runs."""
    first = ("missions/mission_1.txt", "--start-area", "1", "--end-area", "2")
    ground, upstairs = "faults/ground.txt", "faults/upstairs.txt"
    for name, options in {
        "mission_1": first,
        "mission_1, other values": (*first, "--value", "8=9.5", "--seed", "3"),
        "mission_1, events": (*first, "--event", "60=gas_leak"),
        "protocol_2": ("missions/protocol_2.txt",),
        "protocol_3": ("missions/protocol_3.txt", "--seed", "2"),
        "rounds_and_windows": ("missions/rounds_and_windows.json",),
        **{
            f"{path.stem}, {Path(script).stem}": (script, "--faults", f"faults/{path.name}")
            for path in sorted((UMAD / "faults").glob("*.yaml"))
            for script in (ground, upstairs)
        },
    }.items():
        for drive in ("route", "kinematic"):
            run = ("run", *options, "--drive", drive, "--report", "report")
            again = ("resume", "report/run.journal", "--report", "again")
            yield f"{name}, {drive}", (run, ("CUT", "report/run.journal"), again)


def command_results(group: str, only: str, with_prose: bool) -> Iterator[tuple[str, bytes]]:
    """Yield each case of a group whose name contains `only`, and all its output as bytes.

    The output consists of exit statuses, what is printed, and files.
    """
    all_cases = {"plans": mission_cases, "routes": route_cases, "journals": journal_cases}[group]()
    cases = [case for case in all_cases if only in f"{group}: {case[0]}"]
    if not cases:
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        shutil.copytree(UMAD / "missions", folder / "inputs" / "missions")
        shutil.copytree(UMAD / "faults", folder / "inputs" / "faults")
        shutil.copytree(ROOT / "tests/argo_compiler/script/people", folder / "inputs" / "people")
        _load_commands()
        for case, commands in cases:
            case_folder = folder / "case"
            shutil.copytree(folder / "inputs", case_folder)
            inputs = set(case_folder.rglob("*"))
            statuses = [_run_command(command, case_folder) for command in commands]
            content = repr(statuses).encode()
            for path in sorted(set(case_folder.rglob("*")) - inputs):
                if path.is_file():
                    written = _without_times(path, folder)
                    if not with_prose:
                        written = without_prose(path.suffix, written)
                    content += f"\n{path.relative_to(case_folder)}\n".encode() + written
            shutil.rmtree(case_folder)
            yield f"{group}: {case}, exit statuses {statuses}", content


def _load_commands() -> None:
    """Import the commands, so that the processes that are forked for them start fast.

    Also switches off the display of stages, which would depend on the load of the machine.
    """
    from argo_planner.cli import ArgoCommands
    from argo_planner.terminal import stage_display

    stage_display.AFTER = float("inf")

    for command in ArgoCommands.lazy_commands:
        importlib.import_module(command.module)


def _run_command(command: Sequence[str], folder: Path) -> int:
    """Run a command of `argo` in a forked process, with its output in the file `printed`.

    `CUT FILE` keeps the first half of the lines of a file.

    Returns:
        The exit status; that of CUT is 2 if there is no such file, as after a refused run.
    """
    if command[0] == "CUT":
        file = folder / command[1]
        if not file.exists():
            return 2
        lines = file.read_bytes().splitlines(keepends=True)
        file.write_bytes(b"".join(lines[: max(1, len(lines) // 2)]))
        return 0
    sys.stdout.flush()
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    status = 1
    try:
        os.chdir(folder)
        output = os.open("printed", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os.environ["COLUMNS"] = "120"
        sys.argv = ["argo", *command]
        from argo_planner.entry import main as argo

        try:
            argo()
            status = 0
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(status)


def _without_times(path: Path, folder: Path) -> bytes:
    """Return the content of a file without names of temporary folders and wall-clock times."""
    content = path.read_bytes().replace(str(folder).encode(), b"FOLDER")
    if path.suffix == ".journal":
        content = re.sub(rb"(?m)^[0-9a-f]{8} (?=.*FOLDER)", b"CHECKSUM ", content)
    if path.name == "printed":
        content = re.sub(rb"\btook \d+\.\d s\b.*", b"took TIME", content)
    return content


_JSON_STRING = re.compile(rb'"(?:[^"\\]|\\.)*"(?P<colon>\s*:)?')
"""pattern of a JSON string, with the colon behind it if it is a key"""


def without_prose(suffix: str, content: bytes) -> bytes:
    """Return the content of a file without prose, as `--without-prose` describes."""
    if suffix in (".json", ".journal"):
        content = re.sub(rb"(?m)^[0-9a-f]{8} ", b"CHECKSUM ", content)
        return _JSON_STRING.sub(
            lambda found: found[0] if found["colon"] or b" " not in found[0] else b'"PROSE"',
            content,
        )
    if suffix == ".png":
        return content
    return b" ".join(re.findall(rb"\d+(?:\.\d+)?", content))


def print_digests(only: str, groups: Sequence[str], with_prose: bool) -> None:
    """Print the digest and the name of each result whose name contains `only`."""
    for group in groups:
        results = (
            command_results(group, only, with_prose)
            if group in COMMANDS
            else drive_episodes()
            if group == "drive"
            else run_records(group)
        )
        for name, content in results:
            if only not in name:
                continue
            if not with_prose and group not in (*COMMANDS, "drive"):
                content = without_prose(".json", content)
            print(hashlib.sha256(content).hexdigest()[:16], name, flush=True)
            if folder := os.environ.get("SAME_RESULTS_KEEP"):
                (Path(folder) / re.sub(r"\W+", "_", name)).write_bytes(content)


def compute_digests(
    root: Path, only: str, groups: Sequence[str], cache: str, with_prose: bool
) -> list[str]:
    """Run this file with the code of a checkout; print and return its lines `digest name`.

    `cache` is the folder of its cache.
    """
    environment = os.environ | {"PYTHONPATH": str(root), "ARGO_CACHE_DIR": cache}
    prose = "prose" if with_prose else ""
    command = (sys.executable, __file__, "--digests", only, prose, *groups)
    lines = []
    with subprocess.Popen(
        command, cwd=root, env=environment, stdout=subprocess.PIPE, text=True
    ) as p:
        assert p.stdout
        for line in p.stdout:
            lines.append(line.strip())
            print(lines[-1], flush=True)
    if p.returncode:
        raise SystemExit(f"the process with the code of {root} has failed")
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the results that differ; exits with 1 if there are any."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("before", type=Path, help="checkout, or file of digests, to compare with")
    parser.add_argument("groups", nargs="*", metavar="group", help=", ".join(GROUPS))
    parser.add_argument(
        "--only", default="", metavar="TEXT", help="only results whose names contain TEXT"
    )
    parser.add_argument(
        "--write", action="store_true", help="write this checkout's digests to the file instead"
    )
    parser.add_argument(
        "--without-prose", action="store_true", help="compare keys, values and numbers, not texts"
    )
    options = parser.parse_args(arguments)
    with_prose = not options.without_prose
    groups = options.groups or list(GROUPS)
    if unknown := set(groups) - set(GROUPS):
        parser.error(f"there is no group {sorted(unknown)[0]}; choose from: {', '.join(GROUPS)}")
    before: Path = options.before.resolve()
    if not options.write and not before.exists():
        parser.error(f"{before} is neither a checkout nor a file of digests")
    with tempfile.TemporaryDirectory() as old_cache, tempfile.TemporaryDirectory() as new_cache:
        if options.write:
            before.write_text(
                "\n".join(compute_digests(ROOT, options.only, groups, new_cache, with_prose)) + "\n"
            )
            return
        if before.is_dir():
            old = compute_digests(before, options.only, groups, old_cache, with_prose)
        else:
            stored = before.read_text().splitlines()
            old = [
                line
                for line in stored
                if line[17:].split(":", 1)[0] in groups and options.only in line[17:]
            ]
        new = compute_digests(ROOT, options.only, groups, new_cache, with_prose)
    different = [f"before {a}\n today {b}" for a, b in zip_longest(old, new) if a != b]
    print("\n".join(different) or "all results are the same")
    raise SystemExit(bool(different))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--digests"]:
        print_digests(sys.argv[2], sys.argv[4:], bool(sys.argv[3]))
    else:
        main()
