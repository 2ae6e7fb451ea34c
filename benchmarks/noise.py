"""Time and memory that the importer takes for text that is no script.

    python -m benchmarks.noise                      # 1 MB of each kind
    python -m benchmarks.noise words table --size 10000

Each kind is read in a process of its own, after a fixed piece of work in Python and NumPy that
other load on the machine slows as well. It prints the processor time that the import takes (s), the
ratio to that of the fixed work, the most memory of the process (MiB), and how many lines of the
draft are left to decide on, or the error with which the text is refused.
"""

import argparse
import random
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import import_script
from benchmarks.compile import make_catalog
from benchmarks.speed import run_fixed_work
from benchmarks.startup import MAIL

SIZE = 1_000_000
GERMAN = (
    "der die das und Rundgang Kontrollpunkt bitte prüfen Ventil heute Schicht nicht wenn dann "
    "Druck zu hoch Anlage Manometer ablesen geht über größer Stelle Kollegen danke morgen zurück"
)
_draw = random.Random(1)


def _word() -> str:
    return "".join(_draw.choices("abcdefghijklmnoprstuvwz", k=_draw.randint(2, 10)))


def _words() -> str:
    return " ".join(_word() for _ in range(_draw.randint(4, 14)))


def _characters() -> str:
    return "".join(map(chr, _draw.choices(range(1, 256), k=100)))


def _german() -> str:
    return f"{' '.join(_draw.choices(GERMAN.split(), k=9)).capitalize()}."


def _row() -> str:
    return f"{_draw.randint(1, 99)} | {_word()} {_word()} | bar | {_word()} | OK / Not OK | ____"


KINDS: dict[str, tuple[Callable[[], str], str]] = {
    "words": (_words, "\n"),
    "characters": (_characters, ""),
    "one line": (_words, " "),
    "short lines": (_word, "\n\n"),
    "figures": (lambda: " ".join(map(str, _draw.choices(range(100_000), k=10))), "\n"),
    "table": (_row, "\n"),
    "headings": (lambda: "tag | 06:00 | 10:00 | reading | remarks", "\n"),
    "German": (_german, "\n"),
    "mail": (lambda: MAIL, "\n"),
}
"""function that makes a part of the text, and what stands between two parts"""


def make_noise(kind: str, size: int) -> str:
    """Return so many characters of a kind of noise."""
    make, between = KINDS[kind]
    parts: list[str] = []
    length = 0
    while length < size:
        parts.append(make())
        length += len(parts[-1]) + len(between)
    return between.join(parts)[:size]


def measure_in_this_process(kind: str, size: int) -> str:
    """Import a kind of noise, and return its line of the table."""
    catalog, text = make_catalog(), make_noise(kind, size)
    before = time.process_time()
    run_fixed_work()
    between = time.process_time()
    try:
        draft = import_script(text, catalog)
        found = f"{len(draft.left)} of {len(draft.lines)} lines left"
    except DiagnosticError as error:
        found = error.diagnostics[0].message
    seconds = time.process_time() - between
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    ratio = seconds / (between - before)
    return f"{kind:12}{seconds:7.2f} s{ratio:8.1f} x{memory:7.0f} MiB   {found}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one line for each kind."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", metavar="kind", help=", ".join(KINDS))
    parser.add_argument("--size", type=int, default=SIZE, help="characters of each text")
    parser.add_argument("--here", action="store_true", help="read all kinds in this process")
    options = parser.parse_args(arguments)
    for kind in options.kinds or KINDS:
        if kind not in KINDS:
            parser.error(f"there is no kind {kind}; choose from: {', '.join(KINDS)}")
        if options.here:
            print(measure_in_this_process(kind, options.size))
            continue
        own = (sys.executable, "-m", "benchmarks.noise", kind, "--size", str(options.size))
        subprocess.run((*own, "--here"), check=True)


if __name__ == "__main__":
    main()
