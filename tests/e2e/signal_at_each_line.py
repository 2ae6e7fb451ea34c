"""`argo --version` with a signal at each line that it carries out in what answers signals.

`python -m tests.e2e.signal_at_each_line NUMBER` forks a process for each of these lines, and prints
the exit status of each with what it wrote to standard error.
"""

import json
import os
import signal
import sys
import tempfile
import traceback
from itertools import count, takewhile
from types import FrameType
from typing import Any

from argo_planner import cli
from argo_planner.terminal import output, signals

_TRACED = {module.__file__ for module in (cli, output, signals)}


def main(number: int) -> None:
    for status, error in takewhile(bool, (_interrupted(line, number) for line in count(1))):
        print(json.dumps([status, error]))


def _interrupted(line: int, number: int) -> tuple[int, str] | None:
    """Return the exit status and standard error of the command that gets the signal at its `line`,
    or None if it has fewer lines."""
    with tempfile.TemporaryFile() as error, tempfile.TemporaryFile() as reached:
        child = os.fork()
        if child == 0:
            os.dup2(error.fileno(), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            _carry_out(line, number, reached.fileno())
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if not os.fstat(reached.fileno()).st_size:
            return None
        error.seek(0)
        return status, error.read().decode()


def _carry_out(line: int, number: int, reached: int) -> None:
    lines = count(1)

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        if frame.f_code.co_filename not in _TRACED:
            return None
        if event != "call" and next(lines) == line:
            os.write(reached, b"yes")
            os.kill(os.getpid(), number)
        return trace

    sys.argv = ["argo", "--version"]
    status: Any = 1
    try:
        signals.end_at_once()  # as `argo` itself begins
        sys.settrace(trace)
        cli.main()
    except SystemExit as end:
        status = end.code or 0
    except BaseException:
        traceback.print_exc()
    sys.settrace(None)
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    # A test may run where signals are ignored.
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, signal.SIG_DFL)
    main(int(sys.argv[1]))
