"""CP-SAT's solver in a Python program: it can be stopped by the program and by Ctrl-C."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from ortools.sat.python import cp_model

from argo_compiler.route.search import Search

_NOMINAL = 8.0
"""s of a second of CP-SAT's deterministic time, with the strongest linear relaxation"""
_POLLING_INTERVAL = 0.02
"""s between two checks of whether the search must stop"""


def new_solver() -> cp_model.CpSolver:
    """Return a solver with one worker that leaves SIGINT to Python.

    CP-SAT's own handler would replace Python's for good: the next Ctrl-C after the search would end
    the process without a message. And it aborts the process if the search runs in another thread.
    """
    solver = cp_model.CpSolver()
    solver.parameters.catch_sigint_signal = False
    solver.parameters.num_workers = 1
    return solver


def solver_for(search: Search) -> cp_model.CpSolver:
    """Return a solver with the limits of a search and the strongest linear relaxation."""
    solver = new_solver()
    solver.parameters.linearization_level = 2
    solver.parameters.random_seed = search.seed % (1 << 31)
    if search.timed:
        solver.parameters.max_time_in_seconds = max(search.remaining_time(), 0.01)
    else:
        solver.parameters.max_deterministic_time = search.remaining_time() / _NOMINAL
    return solver


def spend_solver_work(search: Search, solver: cp_model.CpSolver) -> None:
    """Add the solver's work, from its deterministic time, to that of the search."""
    search.spend(_NOMINAL * solver.deterministic_time)


def run_solver(
    solver: cp_model.CpSolver,
    model: cp_model.CpModel,
    callback: cp_model.CpSolverSolutionCallback | None = None,
    must_stop: Callable[[], bool] = lambda: False,
) -> int:
    """Run the solver to its end, or until `must_stop` returns True, and return its status.

    KeyboardInterrupt stops the solver and is raised.
    """
    # Python handles signals only in the main thread and between its own instructions. So the solver
    # runs in a thread, and this one waits for it.
    with ThreadPoolExecutor(1) as pool:
        status = pool.submit(solver.solve, model, callback)
        try:
            while True:
                try:
                    return int(status.result(_POLLING_INTERVAL))
                except TimeoutError:
                    if must_stop():
                        solver.stop_search()
        except BaseException:
            solver.stop_search()
            raise
