"""`argo` again and again without loading anew: for tests that kill it many times.

Loads the yard once. Then each line of standard input, a JSON list, is a command that a forked
process carries out: the file for what it prints, after how many seconds it is killed if it still
runs (null: never), and the arguments. Its exit status is printed when it has ended.
"""

import json
import os
import signal
import sys
import time

import argo_planner.cli
import argo_planner.commands.resume
import argo_planner.commands.run
from tests.yard import yard


def main() -> None:
    navigator = yard()
    for module in (argo_planner.commands.run, argo_planner.commands.resume):
        module.load_navigator = lambda _: navigator
    for line in sys.stdin:
        output, after, *arguments = json.loads(line)
        child = os.fork()
        if child == 0:
            file = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            os.dup2(file, 1)
            os.dup2(file, 2)
            sys.argv = ["argo", *arguments]
            try:
                argo_planner.cli.main()
            finally:
                sys.stdout.flush()
                # Not `exit`: the parent's buffers and handlers are not ours.
                status = sys.exc_info()[1]
                os._exit(status.code or 0 if isinstance(status, SystemExit) else 70)
        print(os.waitstatus_to_exitcode(end_of(child, after)), flush=True)


def end_of(child: int, after: float | None) -> int:
    """Waits for the end of a process, and kills it after a time (s) if it has not come by then."""
    deadline = time.monotonic() + (after or 0.0)
    while after is not None and time.monotonic() < deadline:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status
        time.sleep(0.001)
    if after is not None:
        os.kill(child, signal.SIGKILL)
    return os.waitpid(child, 0)[1]


if __name__ == "__main__":
    main()
