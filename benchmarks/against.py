"""Comparison of this checkout's speed with that of another checkout.

    git worktree add ../before COMMIT
    python -m benchmarks.against ../before                       # all cases
    python -m benchmarks.against ../before drive-contact kinematic --repeats 7

Both checkouts run the cases of this file alternately, each time in a new process, so that other
load on the machine slows both. Each checkout has its own cache, which a first run fills that is not
counted. Each case gets one line with three ratios, the time of the other checkout over that of this
one: the median of the ratios of wall time in each repeat, the ratio of the shortest wall times, and
the ratio of the shortest processor times. Processor time is that of all threads and child
processes; other load disturbs it least.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from itertools import cycle
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
MISSIONS = ROOT / "scenarios" / "umad" / "missions"

Work = Callable[[], object]
"""Function that is timed; each call does the same work, or the next piece of it."""


def prepare_random_drive(*, only_turning: bool = False) -> Work:
    """Return a function that makes 50 steps of Drive-v0 with random actions.

    This is as at the start of training. With `only_turning` the robot only turns to and fro, where
    there is room for it.
    """
    import numpy as np

    env = _drive_env(3)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (50, 3)).astype(np.float32)
    if only_turning:
        actions[:, 0] = 0.0

    def work() -> None:
        for action in actions:
            *_, info = env.step(action)
            assert not (only_turning and info["touched"])

    return work


def prepare_contact_drive() -> Work:
    """Return a function that makes 50 steps of Drive-v0 against a wall that the robot touches."""
    import numpy as np

    env = _drive_env(1)
    ahead = np.array([1.0, 0.0, 0.0], np.float32)
    for _ in range(20):
        env.step(ahead)

    def work() -> None:
        for _ in range(50):
            *_, info = env.step(ahead)
            assert info["touched"]

    return work


def prepare_mission_run(
    drive: str,
    file: str = "mission_1.txt",
    areas: Sequence[int] = (1, 2),
    *,
    warmed_up: bool = False,
) -> Work:
    """Return a function that runs a shipped mission once with a drive.

    The site is opened here. The first run in a process also imports the simulator and plans the
    paths; with `warmed_up` such a run is made beforehand, without being timed.
    """
    from argo_env.planning import open_site
    from argo_env.run.session import simulate
    from argo_env.run.spec import RunSpec
    from argo_planner.use_cases.importing import Upload, import_mission

    site = open_site("umad").prepare()
    upload = Upload(file, (MISSIONS / file).read_bytes())
    mission = import_mission(upload, site, *areas).mission
    spec = RunSpec(mission=mission, drive=drive)
    if warmed_up:
        simulate(spec, site)
    return lambda: simulate(spec, site)


def prepare_next_episode(seeds: Sequence[int], *, warmed_up: bool = False) -> Work:
    """Return a function that runs an episode of Inspect-v0 of at most 40 random legal actions.

    Each call takes the next of the seeds, after the last the first. As at the start of training,
    most paths are planned for the first time. With `warmed_up` an episode of each seed is run
    beforehand, so that the paths are known, as later in training.
    """
    import gymnasium as gym
    import numpy as np

    import argo_env  # noqa: F401

    env: Any = gym.make("argo/Inspect-v0", disable_env_checker=True)
    env.reset(seed=100)
    next_seeds = cycle(seeds)

    def work() -> None:
        seed = next(next_seeds)
        env.reset(seed=seed)
        rng = np.random.default_rng(seed)
        for _ in range(40):
            possible = np.flatnonzero(env.unwrapped.action_masks())
            _, _, terminated, truncated, _ = env.step(int(rng.choice(possible)))
            if terminated or truncated:
                return

    for _ in seeds if warmed_up else ():
        work()
    return work


def prepare_import() -> Work:
    """Return a function that imports a script of 2,000 tasks, most of whose lines differ.

    The script is always made by the code of this checkout.
    """
    from compile import make_catalog, make_script  # beside this file

    from argo_compiler.script import import_script

    catalog = make_catalog()
    import_script(make_script(200, catalog), catalog)
    script = make_script(2_000, catalog)
    return lambda: import_script(script, catalog)


def prepare_canonical_import() -> Work:
    """Return a function that imports a script of 10,000 tasks in canonical sentences.

    The script is always made by the code of this checkout, in a process of its own.
    """
    from compile import make_catalog, make_script  # beside this file

    from argo_compiler.script import import_script

    command = (sys.executable, ROOT / "benchmarks" / "compile.py", "--canonical", "10000")
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    script = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, check=True, encoding="utf-8"
    ).stdout
    catalog = make_catalog()
    import_script(make_script(200, catalog), catalog)
    return lambda: import_script(script, catalog)


def prepare_report() -> Work:
    """Return a function that writes a report of mission #1; one was written on the site before."""
    from argo_env.planning import open_site
    from argo_planner.use_cases.reporting import report_files

    site = open_site("umad").prepare()
    record: Any = prepare_mission_run("route")()

    def work() -> object:
        return report_files(record, site.site, site.robot)

    work()
    return work


def prepare_film() -> Work:
    """Return a function that renders a film of mission #1 at 20 times its speed."""
    from argo_env.pictures import write_film
    from argo_env.planning import open_site

    site = open_site("umad").prepare()
    record: Any = prepare_mission_run("route")()

    def work() -> None:
        with tempfile.TemporaryDirectory() as folder:
            write_film(record, site.site, site.robot, Path(folder) / "film.mp4", speed=20)

    return work


CASES: dict[str, tuple[Callable[[], Work], int]] = {
    "drive-free": (partial(prepare_random_drive, only_turning=True), 4),
    "drive-random": (prepare_random_drive, 4),
    "drive-contact": (prepare_contact_drive, 4),
    "kinematic": (partial(prepare_mission_run, "kinematic", warmed_up=True), 3),
    "kinematic-first": (partial(prepare_mission_run, "kinematic"), 1),
    "kinematic-rounds": (partial(prepare_mission_run, "kinematic", "protocol_3.txt", ()), 1),
    "tracked": (partial(prepare_mission_run, "tracked"), 1),
    "route": (partial(prepare_mission_run, "route", warmed_up=True), 10),
    "inspect": (partial(prepare_next_episode, range(1_000_000)), 3),
    "inspect-known": (partial(prepare_next_episode, range(3), warmed_up=True), 3),
    "import": (prepare_import, 1),
    "import-canonical": (prepare_canonical_import, 1),
    "report": (prepare_report, 1),
    "film": (prepare_film, 1),
}
"""Function that prepares the work of each case, and the number of times a process does it."""


def _drive_env(seed: int) -> Any:
    import gymnasium as gym

    import argo_env  # noqa: F401

    env = gym.make("argo/Drive-v0", disable_env_checker=True, time_limit=3600.0).unwrapped
    env.reset(seed=seed)
    return env


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one line for each case."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkout", type=Path, help="folder with the code to compare with")
    parser.add_argument("cases", nargs="*", metavar="case", help=", ".join(CASES))
    parser.add_argument("--repeats", type=int, default=5, help="repeats that are counted")
    options = parser.parse_args(arguments)
    for name in options.cases:
        if name not in CASES:
            parser.error(f"there is no case {name}; choose from: {', '.join(CASES)}")
    before = options.checkout.resolve()
    if not (before / "argo_env").is_dir():
        parser.error(f"{before} is not a checkout of Argo: it has no folder argo_env")
    print(f"{'case':<20} {'median':>7} {'minimum':>7} {'CPU':>7}   before and today (minimum)")
    with tempfile.TemporaryDirectory() as caches:
        for name in options.cases or CASES:
            print(compare_case(name, before, Path(caches), options.repeats), flush=True)


def compare_case(name: str, before: Path, caches: Path, repeats: int) -> str:
    """Time a case in both checkouts in turn, and return its line of the table."""
    times = [
        [
            wall_and_cpu_time_in_process(name, root, caches / cache)
            for root, cache in ((before, "before"), (ROOT, "today"))
        ]
        for _ in range(repeats + 1)
    ][1:]
    old, new = ([pair[k] for pair in times] for k in (0, 1))
    paired = median(a[0] / b[0] for a, b in zip(old, new, strict=True))
    (old_wall, old_cpu), (new_wall, new_cpu) = (
        (min(wall for wall, _ in all), min(cpu for _, cpu in all)) for all in (old, new)
    )
    return (
        f"{name:<20} {paired:7.2f} {old_wall / new_wall:7.2f} {old_cpu / new_cpu:7.2f}   "
        f"{old_wall:.3f} s, {new_wall:.3f} s"
    )


def wall_and_cpu_time_in_process(name: str, root: Path, cache: Path) -> tuple[float, float]:
    """Time a case in a new process with the code of a checkout; return wall and CPU time (s)."""
    environment = os.environ | {"PYTHONPATH": str(root), "ARGO_CACHE_DIR": str(cache)}
    command = (sys.executable, __file__, "--time", name, str(root))
    done = subprocess.run(
        command, cwd=root, env=environment, stdout=subprocess.PIPE, text=True, check=True
    )
    wall, cpu = json.loads(done.stdout.splitlines()[-1])
    return wall, cpu


def print_times_in_this_process(name: str, root: str) -> None:
    """Time a case in this process, and print wall and processor time (s) as JSON."""
    import argo_env

    if not Path(argo_env.__file__).is_relative_to(root):
        raise SystemExit(f"argo_env was imported from {argo_env.__file__}, not from {root}")
    prepare, calls = CASES[name]
    work = prepare()
    wall, cpu = time.perf_counter(), sum(os.times()[:4])
    for _ in range(calls):
        work()
    print(json.dumps([time.perf_counter() - wall, sum(os.times()[:4]) - cpu]))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--time"]:
        print_times_in_this_process(*sys.argv[2:])
    else:
        main()
