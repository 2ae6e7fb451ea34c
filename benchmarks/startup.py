"""Time that commands need to start and do very little, relative to importing NumPy.

    python benchmarks/startup.py
    python benchmarks/startup.py --repeats 20

Each command runs in a new process, alternately with `python -c "import numpy"`, so that other load
on the machine slows both. It prints the median of the ratios of each repeat, and the ratio of the
shortest times. The first repeat, which fills the caches on the disk, is not counted. Python's
compiled modules are among them, also where the environment tells Python to write none: they go to a
temporary folder then.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from statistics import median
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "scenarios" / "umad" / "missions" / "mission_1.txt"
AREAS = ("--start-area", "1", "--end-area", "2")
CANONICAL = """\
Mission Protocol #1
Maximum duration: 30 minutes

1. Set the starting point in starting area 1.
2. Check checkpoint #4.
3. Check checkpoint #8. If checkpoint #8 is above 5, go to step 5.
4. Wait 2 minutes.
5. Go to starting area 2.
"""
"""script in the sentences that `format_script` writes"""
MAIL = """\
Hi Sam,

hope you had a good weekend. Could the robot do a quick round tonight?
Start in starting area 1 please.
I'd like to have pressure gauge 3, then valve R12 photographed.
If the pressure is too high, have a look at valve R25.
Not sure about checkpoint 15, ask Jonas.

Thanks, Bo
"""
"""script with lines that are left to decide on"""
INCOMPLETE = 3
"""exit status of a command whose script is such a draft"""


class StartupRatios(NamedTuple):
    """Times of a command, and of `import numpy` beside it."""

    median_ratio: float
    """median of the ratios of its time to that of the import, one for each repeat"""
    shortest_ratio: float
    """ratio of the shortest times"""
    median_seconds: float
    """median of its wall-clock times"""
    max_ratio: float | None
    """largest allowed ratio; None: any is allowed"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one line for each command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9, help="repeats that are counted")
    parser.add_argument(
        "--only", default="", metavar="WORD", help="only commands whose name contains WORD"
    )
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        chosen = {
            name: c
            for name, c in commands_and_max_ratios(Path(folder)).items()
            if options.only in name
        }
        measured = measure_ratios_to_numpy(chosen, options.repeats)
    for name, (paired, shortest, seconds, limit) in measured.items():
        requirement = f"at most {limit:g}" if limit else ""
        print(f"{name:24} {paired:6.2f} {shortest:6.2f}   {seconds:6.3f} s   {requirement}")


def commands_and_max_ratios(folder: Path) -> dict[str, tuple[Sequence[str], float | None]]:
    """Return the commands by name, each with its largest allowed ratio, or None if it has none.

    First writes the scripts, and the mission that one of them checks, to the folder.
    """
    canonical, mail = folder / "canonical.txt", folder / "mail.txt"
    canonical.write_text(CANONICAL, encoding="utf-8")
    mail.write_text(MAIL, encoding="utf-8")
    argo = (sys.executable, "-m", "argo_planner")
    mission = str(folder / "mission.json")
    importing = (*argo, "import", str(SCRIPT), *AREAS, "-o", mission, "--force")
    time_command(importing)
    return {
        "argo --help": ((*argo, "--help"), 1.5),
        "import argo_compiler": ((sys.executable, "-c", "import argo_compiler"), None),
        "import argo_env": ((sys.executable, "-c", "import argo_env"), None),
        "argo check, a script": ((*argo, "check", str(SCRIPT), *AREAS), 4.0),
        "argo check, canonical": ((*argo, "check", str(canonical)), 4.0),
        "argo check, a mail": ((*argo, "check", str(mail)), 4.0),
        "argo check, a mission": ((*argo, "check", mission), 3.0),
        "argo import": (importing, 4.0),
        "argo import, a mail": ((*argo, "import", str(mail), "-o", f"{mail}.json"), 4.0),
        "argo run --help": ((*argo, "run", "--help"), None),
    }


def measure_ratios_to_numpy(
    commands: dict[str, tuple[Sequence[str], float | None]], repeats: int
) -> dict[str, StartupRatios]:
    """Time commands relative to `import numpy`; return the results by the commands' names."""
    numpy = (sys.executable, "-c", "import numpy")
    results = {}
    for name, (command, limit) in commands.items():
        pairs = [(time_command(numpy), time_command(command)) for _ in range(repeats + 1)][1:]
        results[name] = StartupRatios(
            median(own / base for base, own in pairs),
            min(own for _, own in pairs) / min(base for base, _ in pairs),
            median(own for _, own in pairs),
            limit,
        )
    return results


def time_command(command: Sequence[str]) -> float:
    """Run a command in a process, and return the wall-clock time (s) that it took."""
    environment, nowhere = _environment(), subprocess.DEVNULL
    started = time.perf_counter()
    done = subprocess.run(
        command, cwd=ROOT, env=environment, stdout=nowhere, stderr=nowhere, check=False
    )
    if done.returncode not in (0, INCOMPLETE):
        done.check_returncode()
    return time.perf_counter() - started


def _environment() -> dict[str, str]:
    """Return the environment of the commands, in which Python stores what it compiles."""
    environment = dict(os.environ)
    if environment.pop("PYTHONDONTWRITEBYTECODE", ""):
        environment["PYTHONPYCACHEPREFIX"] = _compiled().name
    return environment


@cache
def _compiled() -> "tempfile.TemporaryDirectory[str]":
    return tempfile.TemporaryDirectory()


if __name__ == "__main__":
    main()
