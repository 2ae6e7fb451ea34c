"""How long commands take until they are done with next to nothing, beside importing NumPy.

    python benchmarks/startup.py
    python benchmarks/startup.py --repeats 20

Each command runs in a process of its own, in turn with `python -c "import numpy"`, so that what
slows the machine down slows both. What is printed is the median of the ratios within each turn, and
the ratio of the least times. The first turn, which fills the caches on the disk, does not count.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[1]
SHEET = ROOT / "scenarios" / "umad" / "missions" / "mission_1.txt"
AREAS = ("--start-area", "1", "--end-area", "2")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9, help="turns that count")
    parser.add_argument("--only", default="", metavar="WORD", help="commands whose name has it")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        chosen = {name: c for name, c in commands(Path(folder)).items() if given.only in name}
        measured = measure(chosen, given.repeats)
    for name, (paired, least, seconds, limit) in measured.items():
        asked = f"at most {limit:g}" if limit else ""
        print(f"{name:24} {paired:6.2f} {least:6.2f}   {seconds:6.3f} s   {asked}")


def commands(folder: Path) -> dict[str, tuple[Sequence[str], float | None]]:
    """Return the commands by their names, with the ratio that each may have, if one is set. The
    mission that one of them checks is imported first."""
    argo = (sys.executable, "-m", "argo_planner")
    mission = str(folder / "mission.json")
    importing = (*argo, "import", str(SHEET), *AREAS, "-o", mission, "--force")
    seconds(importing)
    return {
        "argo --help": ((*argo, "--help"), 1.5),
        "import argo_compiler": ((sys.executable, "-c", "import argo_compiler"), None),
        "import argo_env": ((sys.executable, "-c", "import argo_env"), None),
        "argo check, a script": ((*argo, "check", str(SHEET), *AREAS), 5.0),
        "argo check, a mission": ((*argo, "check", mission), 3.0),
        "argo import": (importing, None),
        "argo run --help": ((*argo, "run", "--help"), None),
    }


def measure(
    commands: dict[str, tuple[Sequence[str], float | None]], repeats: int
) -> dict[str, tuple[float, float, float, float | None]]:
    """For each command: the median of the paired ratios, the ratio of the least times, the median
    in seconds, and what it may be."""
    numpy = (sys.executable, "-c", "import numpy")
    found = {}
    for name, (command, limit) in commands.items():
        pairs = [(seconds(numpy), seconds(command)) for _ in range(repeats + 1)][1:]
        found[name] = (
            median(own / base for base, own in pairs),
            min(own for _, own in pairs) / min(base for base, _ in pairs),
            median(own for _, own in pairs),
            limit,
        )
    return found


def seconds(command: Sequence[str]) -> float:
    """How long a process takes from its start to its end."""
    started = time.perf_counter()
    subprocess.run(
        command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True
    )
    return time.perf_counter() - started


if __name__ == "__main__":
    main()
