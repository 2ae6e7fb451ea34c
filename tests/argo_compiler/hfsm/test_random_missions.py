"""Coverage of the language by the random missions."""

import json
import subprocess
import sys

HAPPENS = {
    "a wait ends by duration": 10,
    "a wait ends by event": 3,
    "a wait ends by conditions": 3,
    "a wait's limit": 10,
    "an action's limit": 10,
    "a hold's limit": 3,
    "a hard window is missed": 5,
    "missed_target": 2,
    "a failure branches": 5,
    "a round that waited begins": 5,
    "a group's time is up": 5,
    "done by hand": 10,
    "TIME_UP": 10,
    "late success": 10,
    "unreadable": 10,
    "unreachable": 10,
    "completed with failures": 5,
    "begins paused": 5,
}
"""least number of occurrences in 500 machines"""


def test_random_missions_come_to_all_there_is():
    """It runs in a process of its own, as the campaign replaces Hypothesis's strategies."""
    campaign = [sys.executable, "-m", "tests.campaigns.machines", "--count", "500"]
    done = subprocess.run(campaign, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    happened = json.loads(done.stdout.splitlines()[-1])
    rare = {what for what, least in HAPPENS.items() if happened.get(what, 0) < least}
    assert not rare, happened
