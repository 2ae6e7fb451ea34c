"""CP-SAT's solver as part of a Python program: Ctrl-C ends it as it ends all else."""

import threading
from concurrent.futures import ThreadPoolExecutor

from ortools.sat.python import cp_model


def new_solver() -> cp_model.CpSolver:
    """A solver that leaves SIGINT to Python.

    Its own handler would stay in Python's place after the search, so that the next Ctrl-C ends the
    process without a word; and aborts it where the search runs in another thread.
    """
    solver = cp_model.CpSolver()
    solver.parameters.catch_sigint_signal = False
    return solver


def run_solver(
    solver: cp_model.CpSolver,
    model: cp_model.CpModel,
    callback: cp_model.CpSolverSolutionCallback | None = None,
) -> int:
    """Searches and returns the status. KeyboardInterrupt stops the search and is raised."""
    if threading.current_thread() is not threading.main_thread():
        return int(solver.solve(model, callback))
    # Python answers signals in the main thread and between its own steps only, so that one waits.
    with ThreadPoolExecutor(1) as pool:
        status = pool.submit(solver.solve, model, callback)
        try:
            return int(status.result())
        except BaseException:
            solver.stop_search()
            raise
