"""Signals that Python can't raise where they arrive."""

import subprocess
import sys

LOST = """
import os, signal, time
from argo_planner.terminal.signals import Interrupted, SignalWatch, raise_on_signals

class Interrupting:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0)  # the handler raises here, and Python discards what destructors raise

signal.signal(signal.SIGTERM, signal.SIG_DFL)
raise_on_signals(SignalWatch())
try:
    Interrupting()
    time.sleep(30.0)
except Interrupted as interrupted:
    print(interrupted.status)
"""


def test_an_interruption_that_is_lost_in_a_destructor_is_raised_again_soon() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOST], capture_output=True, text=True, check=True, timeout=25
    )
    assert done.stdout == "143\n"
    assert not done.stderr
