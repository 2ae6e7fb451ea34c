"""CP-SAT's solver as part of a Python program: it ends when it is asked to, and by Ctrl-C."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from ortools.sat.python import cp_model

from argo_compiler.route.search import Search

_NOMINAL = 8.0
"""s for a second of CP-SAT's own count of its work, with the linear relaxation at its strongest"""
_LOOKS = 0.02
"""s between two looks at whether to go on"""


def new_solver() -> cp_model.CpSolver:
    """A solver of one worker that leaves SIGINT to Python.

    Its own handler would stay in Python's place after the search, so that the next Ctrl-C ends the
    process without a word; and aborts it where the search runs in another thread.
    """
    solver = cp_model.CpSolver()
    solver.parameters.catch_sigint_signal = False
    solver.parameters.num_workers = 1
    return solver


def solver_for(search: Search) -> cp_model.CpSolver:
    """A solver with the limits of a search, and the linear relaxation at its strongest."""
    solver = new_solver()
    solver.parameters.linearization_level = 2
    solver.parameters.random_seed = search.seed % (1 << 31)
    if search.timed:
        solver.parameters.max_time_in_seconds = max(search.left(), 0.01)
    else:
        solver.parameters.max_deterministic_time = search.left() / _NOMINAL
    return solver


def spend(search: Search, solver: cp_model.CpSolver) -> None:
    """Counts what the solver has worked as the search's."""
    search.spend(_NOMINAL * solver.deterministic_time)


def run_solver(
    solver: cp_model.CpSolver,
    model: cp_model.CpModel,
    callback: cp_model.CpSolverSolutionCallback | None = None,
    over: Callable[[], bool] = lambda: False,
) -> int:
    """Searches until it is over, and returns the status. KeyboardInterrupt stops the search and is
    raised."""
    # Python answers signals in the main thread and between its own steps only, so that one waits.
    with ThreadPoolExecutor(1) as pool:
        status = pool.submit(solver.solve, model, callback)
        try:
            while True:
                try:
                    return int(status.result(_LOOKS))
                except TimeoutError:
                    if over():
                        solver.stop_search()
        except BaseException:
            solver.stop_search()
            raise
