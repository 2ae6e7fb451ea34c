"""The commands' `--seed`, read by real processes."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize("name", ["drives", "faults", "perception"])
def test_a_negative_seed_is_refused_in_one_line(name):
    command = [sys.executable, "-m", f"benchmarks.{name}", "--seed", "-1"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert run.stderr.splitlines()[-1].endswith("argument --seed: it has to be 0 or more, not -1")
    assert "Traceback" not in run.stderr
