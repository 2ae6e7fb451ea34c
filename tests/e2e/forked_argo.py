"""Server that runs `argo` in forked processes, for tests that do not depend on how it starts.

It loads the commands once. Each line of standard input is then a request, a JSON object:

- `{"open": site}` opens a site and prepares its navigator for all later requests.
- `{"drive": [mission, start area, end area]}` runs a mission on UMAD, so that all later requests
  know its paths.
- Any other object is a command for a forked process: `arguments`, `cwd`, `environment`, the files
  to which `stdout` and `stderr` are appended, and the `signal` that is sent `after` so many seconds
  if the command still runs (null: never).

The response is a line with the exit status.
"""

import gc
import json
import multiprocessing
import os
import sys
import time
import traceback
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from argo_compiler.script import parse
from argo_env.evaluation.report import page as evaluation_report
from argo_env.pictures import film
from argo_env.planning import open_site
from argo_env.report import html as run_report
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.cli import ArgoCommands, main
from argo_planner.terminal import stage_display
from argo_planner.terminal.files import read_upload
from argo_planner.terminal.signals import exit_on_signals
from argo_planner.use_cases import evaluating
from argo_planner.use_cases.importing import import_mission
from tests.forking import draw_small_overviews, load_late_modules

# On a busy machine any stage may take long enough to be shown.
stage_display.AFTER = float("inf")
# These tests do not look at pictures.
draw_small_overviews()
film.MP4_SIZE = film.GIF_SIZE = (128, 80)
# Workers of an evaluation are forked from the command, which has loaded all modules they need.
evaluating.context_with = lambda *_: multiprocessing.get_context("fork")


def serve() -> None:
    for command in ArgoCommands.lazy_commands:
        import_module(command.module)
    load_late_modules()
    parse("Mission Protocol #1\n1. Check checkpoint #1")
    run_report._template()
    for name in ("evaluation.html.j2", "comparison.html.j2"):
        evaluation_report._template(name)
    gc.freeze()  # the collector of forked processes need not visit the loaded objects
    exit_on_signals()  # as `argo` itself begins
    opened = []
    for line in sys.stdin:
        request, status = json.loads(line), 0
        if "open" in request:
            opened.append(open_site(request["open"]))
            opened[-1].navigator.prepare()
        elif "drive" in request:
            _drive(*request["drive"])
        elif child := os.fork():
            status = _wait_for_end(child, request["after"], request["signal"])
        else:
            # Not `exit`: that would flush the parent's buffers and run its handlers.
            os._exit(_exit_status(lambda request=request: _run_command(request)))
        print(os.waitstatus_to_exitcode(status), flush=True)


def _drive(path: str, start_area: int, end_area: int) -> None:
    """Run a mission as evaluations do: the site keeps the paths that it has found."""
    site = open_site("umad")
    mission = import_mission(read_upload(Path(path)), site, start_area, end_area).mission
    simulate(RunSpec(mission=mission, site=site.reference, drive="route"), site)


def _run_command(request: dict[str, Any]) -> None:
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    for number, name in ((1, "stdout"), (2, "stderr")):
        os.dup2(os.open(request[name], os.O_WRONLY | os.O_CREAT | os.O_APPEND), number)
    os.chdir(request["cwd"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.argv = ["argo", *request["arguments"]]
    main()


def _exit_status(act: Callable[[], None]) -> int:
    """Call a function as a program; return its exit status and print errors as Python would."""
    try:
        act()
    except SystemExit as end:
        status = end.code
    except BaseException:
        traceback.print_exc()
        status = 1
    else:
        status = 0
    sys.stdout.flush()
    sys.stderr.flush()
    if status is None or isinstance(status, int):
        return status or 0
    os.write(2, f"{status}\n".encode())
    return 1


def _wait_for_end(child: int, after: float | None, number: int) -> int:
    """Wait for the end of a process and return its wait status.

    If it still runs after `after` s, it gets the signal `number`; `after` None means never.
    """
    deadline = time.monotonic() + (after or 0.0)
    while after is not None and time.monotonic() < deadline:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status
        time.sleep(0.001)
    if after is not None:
        os.kill(child, number)
    return os.waitpid(child, 0)[1]


if __name__ == "__main__":
    serve()
