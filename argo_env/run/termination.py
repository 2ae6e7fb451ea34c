"""Reasons for which a run ends before its mission does: time limit, battery, standstill."""

import math

from argo_env.drives.powertrain import Powertrain
from argo_env.run.log import RunLog
from argo_env.run.machine import Machine
from argo_env.run.robot import RobotPower
from argo_env.run.run_setup import RunSetup
from argo_env.run.verdict import VerdictCode, VerdictPart

TIME_LIMIT = 4 * 3600.0  # s of simulated time after which a run is stopped
SETTLING = 120.0  # s that a robot at a standstill waits for findings of the last fault


def reason_run_cannot_continue(now: float, supply: RobotPower) -> VerdictPart | None:
    """Return why the run can't continue at time `now` (s), whatever event occurs; None if it can.

    The reason is the time limit of a run, or an empty battery.
    """
    if now >= TIME_LIMIT:
        return VerdictPart(code=VerdictCode.RUN_TOO_LONG, times=(now,))
    if supply.empty:
        return VerdictPart(code=VerdictCode.BATTERY_EMPTY, times=(now,))
    return None


def standstill_reason(
    now: float, machine: Machine, setup: RunSetup, log: RunLog, acting: bool
) -> VerdictPart | None:
    """Return why the robot stands still for good at time `now` (s); None if it does not.

    For good means unless an event from outside occurs; the caller knows that none is scheduled. A
    robot that is `acting` by hand does not stand still, unless its emergency stop holds it.
    """
    waits = not acting and machine.running is None and machine.next_deadline is None
    is_stopped = is_emergency_stopped(setup)
    if not (waits or is_stopped):
        return None
    since, final_from = _standstill_times(setup, log)
    if now < final_from:
        return None
    why = VerdictCode.HELD_BY_STOP if is_stopped else VerdictCode.WAITS_IN_VAIN
    if machine.paused:
        begins = machine.hfsm.supervised and not log.tasks
        why = VerdictCode.NEVER_BEGUN if begins else VerdictCode.STAYS_PAUSED
    return VerdictPart(code=why, times=(since,))


def is_emergency_stopped(setup: RunSetup) -> bool:
    """Return True if the emergency stop holds the robot."""
    return isinstance(setup.drive, Powertrain) and setup.drive.stop_pressed


def time_standstill_becomes_final(setup: RunSetup, log: RunLog) -> float:
    """Return the time (s) from which on a robot that still stands does so for good.

    It is that of the last event, or `SETTLING` after the last change of a fault if that is later;
    infinite while a fault is still to begin or end.
    """
    return _standstill_times(setup, log)[1]


def _standstill_times(setup: RunSetup, log: RunLog) -> tuple[float, float]:
    """Return the last time (s) of an event or fault change, and `time_standstill_becomes_final`."""
    since, schedule = log.last_event, setup.schedule
    if schedule is None or not schedule.faults:
        return since, since
    # The robot may still find a fault that has begun, or notice that one has ended.
    since = max(since, schedule.latest_change_time_or_zero)
    return since, math.inf if schedule.has_changes_left else since + SETTLING
