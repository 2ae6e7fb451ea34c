"""Why a run ends before its mission does."""

import math

from argo_env.drives.powertrain import Powertrain
from argo_env.run.log import RunLog
from argo_env.run.machine import Machine
from argo_env.run.robot import RobotPower
from argo_env.run.run_setup import RunSetup

TIME_LIMIT = 4 * 3600.0  # s of simulated time after which a run is stopped
SETTLING = 120.0  # s that a robot which stands still waits for what faults may lead to


def exhaustion_reason(now: float, supply: RobotPower) -> str | None:
    """Why nothing can go on at time `now` (s), whatever is told; None: it can."""
    if now >= TIME_LIMIT:
        return f"it was stopped after {now:.0f} s, Argo's limit for a run"
    if supply.empty:
        return f"the battery was empty after {now:.0f} s"
    return None


def standstill_reason(
    now: float, machine: Machine, setup: RunSetup, log: RunLog, acting: bool
) -> str | None:
    """Why nothing goes on by itself at time `now` (s), if nothing is to occur any more; `acting`
    by hand the robot does not stand."""
    waits = not acting and machine.running is None and machine.next_deadline is None
    held = is_held(setup)
    if not (waits or held):
        return None
    since, settled = _stands(setup, log)
    if now < settled:
        return None
    why = "held by its emergency stop" if held else "waiting for an event"
    why = "paused" if machine.paused else why
    stands = f"the robot stands still since {since:.0f} s, {why}, and nothing more occurs"
    if machine.paused and machine.hfsm.supervised and not log.tasks:
        stands += ": a supervisory mission begins when a person resumes it (the event `resume`)"
    return stands


def is_held(setup: RunSetup) -> bool:
    """Whether the emergency stop holds the robot."""
    return isinstance(setup.drive, Powertrain) and setup.drive.pressed


def settled_at(setup: RunSetup, log: RunLog) -> float:
    """s, from when on a robot that stands still now is taken to do so for good."""
    return _stands(setup, log)[1]


def _stands(setup: RunSetup, log: RunLog) -> tuple[float, float]:
    """s, since when a robot that stands still does so, and from when on for good."""
    since, schedule = log.last_event, setup.schedule
    if schedule is None or not schedule.faults:
        return since, since
    # What has begun or ended may still be found.
    since = max(since, schedule.last_change)
    return since, math.inf if schedule.pending else since + SETTLING
