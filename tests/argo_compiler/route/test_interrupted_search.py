"""Ctrl-C ends a search like any Python code, and searches in threads find the same as alone."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from argo_compiler.route import suggest_route
from tests.argo_compiler.route.random_problems import random_problem

_INTERRUPTED = """
import os, random, signal, sys, threading
from ortools.sat.python import cp_model
from argo_compiler.route.cp_solver import new_solver, run_solver

signal.signal(signal.SIGINT, signal.default_int_handler)  # else ignored in the background
model, draw = cp_model.CpModel(), random.Random(1)
picked = [model.new_bool_var("") for _ in range(300)]
for _ in range(80):
    model.add(sum(draw.randint(1, 1000) * one for one in picked) <= 20000)
model.maximize(sum(draw.randint(900, 1000) * one for one in picked))


class Interrupting(cp_model.CpSolverSolutionCallback):
    done = False

    def on_solution_callback(self):
        if not self.done:
            self.done = True
            os.kill(os.getpid(), signal.SIGINT)


def search():
    solver = new_solver()
    solver.parameters.num_workers = 1
    run_solver(solver, model, Interrupting())


for k in range(2):
    try:
        if sys.argv[1] == "main":
            search()
        else:
            thread = threading.Thread(target=search, daemon=True)
            thread.start()
            thread.join()
        print("went on")
    except KeyboardInterrupt:
        print("interrupted")
sys.stdout.flush()
os._exit(0)  # the searches of other threads have no time limit
"""


@pytest.mark.parametrize("thread", ["main", "other"])
def test_ctrl_c_is_left_to_python(thread: str) -> None:
    """Python handles both the first and a second signal: the search replaces no handler."""
    run = subprocess.run(
        [sys.executable, "-c", _INTERRUPTED, thread], capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stdout.split()) == (0, ["interrupted", "interrupted"])
    assert run.stderr == ""


def test_searches_in_threads_find_what_they_find_alone() -> None:
    problems = [random_problem(np.random.default_rng(seed), 8) for seed in range(24)]

    def found(problem):  # type: ignore[no-untyped-def]
        made = suggest_route(problem, time_limit=120.0, explain=False)
        return made.proven, made.prize, made.cost, made.infeasible

    alone = [found(problem) for problem in problems]
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(found, problems)) == alone
