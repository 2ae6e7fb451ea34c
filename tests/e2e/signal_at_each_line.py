"""Test program that sends `argo --version` a signal at each line of the code that handles signals.

`python -m tests.e2e.signal_at_each_line NUMBER` forks a process for each of these lines. It prints
the exit status and the standard error of each.
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
    for status, error in takewhile(bool, (_run_interrupted(line, number) for line in count(1))):
        print(json.dumps([status, error]))


def _run_interrupted(line: int, number: int) -> tuple[int, str] | None:
    """Return the exit status and standard error of a command that gets a signal at a line.

    Executed lines of the traced modules are counted from 1; None: the command executes fewer lines.
    """
    with tempfile.TemporaryFile() as error, tempfile.TemporaryFile() as reached:
        child = os.fork()
        if child == 0:
            os.dup2(error.fileno(), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            _run_command(line, number, reached.fileno())
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if not os.fstat(reached.fileno()).st_size:
            return None
        error.seek(0)
        return status, error.read().decode()


def _run_command(line: int, number: int, reached: int) -> None:
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
        signals.exit_on_signals()  # as `argo` itself begins
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
    # The parent process may ignore signals, and this one would inherit that.
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, signal.SIG_DFL)
    main(int(sys.argv[1]))
