"""Possible effects of faults, to find the cause of each finding, failure and abortion of a run.

Written from docs/faults.md and docs/signals.md, not from the code.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from argo_compiler.hfsm import Outcome
from argo_compiler.il import EventKind
from argo_env.faults.checkpoints import AbnormalValue, DisplacedCheckpoint
from argo_env.faults.fault import Fault
from argo_env.faults.kinds import AnyFault
from argo_env.faults.plant import AbnormalPump, GasLeakFault, HotSpotFault, PlatformAlarm
from argo_env.faults.robot import (
    ConnectionLoss,
    DriveDysfunction,
    EmergencyStop,
    LowBattery,
    SensorDysfunction,
    WornBattery,
)
from argo_env.faults.walkway import BlockedStairs, Brick, MissingPlate
from argo_env.run.record import FROM_READING, Anomaly, RunRecord, TaskRun
from argo_env.site import Site
from argo_env.site.shapes import Box

_STEP = 0.11  # s, a time step of a drive, after which starts and ends are noticed
_GAS_STAYS = 120.0  # s until escaped gas has dispersed
_GAS_REACHES = 25.0  # m
_SPOT_ERROR = 2.5  # m, largest error of a hot spot's position
_OBSTACLE_ERROR = 0.35  # m, largest distance of a detection from an obstacle or a hole
_SLOW = 0.7  # share of the speed below which a drive may be reported: 0.6 plus errors
_DRIVE_WINDOW = 10.0 + 1.0  # s, window of the drive's watch plus its period

_OBSTACLES = (Brick, BlockedStairs, MissingPlate)


@dataclass(frozen=True)
class FaultCause:
    """Kind of fault as a cause of a finding."""

    fault: type[Fault]
    lag: float = 0.0
    """seconds after its end in which it may still be detected"""
    fits: Callable[[AnyFault, Anomaly, Site], bool] = lambda *_: True
    """function that returns True if the finding agrees with the effects of that fault"""


def _same_checkpoint(fault: AnyFault, anomaly: Anomaly, site: Site) -> bool:
    assert isinstance(fault, AbnormalValue)
    assert fault.checkpoint is not None
    return anomaly.detail.startswith(f"{site.checkpoint(fault.checkpoint).name} shows ")


def _noisy(fault: AnyFault, _: Anomaly, __: Site) -> bool:
    return isinstance(fault, SensorDysfunction) and fault.effect == "noise"


def _gas_is_in_reach(fault: AnyFault, anomaly: Anomaly, _: Site) -> bool:
    assert isinstance(fault, GasLeakFault)
    at = anomaly.noticed_from
    return at is not None and _distance(fault.place, at) <= _GAS_REACHES


def _hot_spot_is_there(fault: AnyFault, anomaly: Anomaly, _: Site) -> bool:
    assert isinstance(fault, HotSpotFault)
    return anomaly.place is not None and _distance(fault.place, anomaly.place) <= _SPOT_ERROR


def _same_pump(fault: AnyFault, anomaly: Anomaly, _: Site) -> bool:
    assert isinstance(fault, AbnormalPump)
    return anomaly.detail.startswith(f"{fault.pump} sounds ")


def _obstacle_is_there(fault: AnyFault, anomaly: Anomaly, site: Site) -> bool:
    before = {element.name for element in site.elements}
    added = [e for e in fault.site_elements_with_fault(site) if e.name not in before]
    place = anomaly.place
    return place is not None and any(
        isinstance(solid, Box)
        and math.dist(solid.center[:2], place[:2])
        <= math.hypot(*solid.size[:2]) / 2 + _OBSTACLE_ERROR
        and abs(solid.center[2] - solid.size[2] / 2 - place[2]) <= _OBSTACLE_ERROR
        for element in added
        for solid in element.solids
    )


def _plate_is_missing_there(fault: AnyFault, anomaly: Anomaly, site: Site) -> bool:
    assert isinstance(fault, MissingPlate)
    assert fault.rect is not None
    if anomaly.place is None or site.floor_at(anomaly.place[2]) != fault.floor:
        return False
    (x, y, _), (x0, y0, x1, y1), error = anomaly.place, fault.rect, _OBSTACLE_ERROR
    return x0 - error <= x <= x1 + error and y0 - error <= y <= y1 + error


def _slow(fault: AnyFault, _: Anomaly, __: Site) -> bool:
    return isinstance(fault, DriveDysfunction) and (fault.speed or 0.0) < _SLOW


CAUSES: dict[tuple[EventKind, str], tuple[FaultCause, ...]] = {
    (EventKind.ABNORMAL_READING, FROM_READING): (
        FaultCause(AbnormalValue, fits=_same_checkpoint),
        FaultCause(SensorDysfunction, fits=_noisy),
    ),
    (EventKind.GAS_LEAK, "gas"): (FaultCause(GasLeakFault, _GAS_STAYS, _gas_is_in_reach),),
    (EventKind.HOT_SPOT, "heat"): (FaultCause(HotSpotFault, fits=_hot_spot_is_there),),
    (EventKind.ABNORMAL_SOUND, "pumps"): (FaultCause(AbnormalPump, fits=_same_pump),),
    (EventKind.PLATFORM_ALARM, "alarm"): (FaultCause(PlatformAlarm),),
    (EventKind.POSITIVE_OBSTACLE, "terrain"): (
        FaultCause(Brick, fits=_obstacle_is_there),
        FaultCause(BlockedStairs, fits=_obstacle_is_there),
    ),
    (EventKind.NEGATIVE_OBSTACLE, "terrain"): (
        FaultCause(MissingPlate, fits=_plate_is_missing_there),
    ),
    (EventKind.LOW_BATTERY, "battery"): (FaultCause(LowBattery), FaultCause(WornBattery)),
    (EventKind.CONNECTION_LOST, "connection"): (FaultCause(ConnectionLoss),),
    (EventKind.EMERGENCY_STOP, "emergency stop"): (FaultCause(EmergencyStop),),
    (EventKind.DYSFUNCTION, "camera"): (FaultCause(SensorDysfunction),),
    (EventKind.DYSFUNCTION, "drive"): (FaultCause(DriveDysfunction, _DRIVE_WINDOW, _slow),),
}  # fmt: skip
"""Faults that may cause a finding, by its kind and the watch that reports it."""

ENDS: dict[tuple[EventKind, str], EventKind] = {
    (EventKind.ALL_CLEAR, "gas"): EventKind.GAS_LEAK,
    (EventKind.ALL_CLEAR, "alarm"): EventKind.PLATFORM_ALARM,
    (EventKind.BATTERY_CHARGED, "battery"): EventKind.LOW_BATTERY,
    (EventKind.CONNECTION_RESTORED, "connection"): EventKind.CONNECTION_LOST,
}
"""Finding that must precede the report of its end, by kind and watch of that report."""

_REPORTED_ONCE = frozenset({"emergency stop", "camera", "drive", "alarm"})
"""watches that report each fault once while it lasts, wherever the robot is"""


def find_causes(anomaly: Anomaly, faults: Sequence[AnyFault], site: Site) -> tuple[AnyFault, ...]:
    """Return the faults that may have caused a finding."""
    return tuple(
        fault
        for cause in CAUSES.get((anomaly.kind, anomaly.source), ())
        for fault in faults
        if isinstance(fault, cause.fault)
        and _is_present(fault, anomaly.t, cause.lag)
        and cause.fits(fault, anomaly, site)
    )


def findings_without_cause(record: RunRecord, site: Site) -> tuple[str, ...]:
    """Return the findings, ends of findings, contacts and mishaps of a run without a cause."""
    texts = [
        f"{a.t:g} s: {a.kind} ({a.source}): {a.detail}"
        for k, a in enumerate(record.anomalies)
        if not (_may_have_ended(record, k) if a.is_end else find_causes(a, record.faults, site))
    ]
    texts += _repeated_findings(record, site)
    if not any(isinstance(fault, _OBSTACLES) for fault in record.faults):
        texts += [f"{c.start:g} s: {c.link} touches {c.element}" for c in record.contacts]
        texts += [f"{m.t:g} s: {m.trouble}: {m.detail}" for m in record.mishaps]
    return tuple(texts)


def failures_without_cause(record: RunRecord) -> tuple[str, ...]:
    """Return the failed tasks, the interruptions and the failure of a mission without a cause."""
    texts = [
        f"{run.end:g} s: task {run.task} failed: {run.reason}"
        for run in record.tasks
        if run.outcome == "failed" and not _may_fail(run, record)
    ]
    first_times = {a.kind: a.t for a in reversed(record.anomalies)}
    texts += [
        f"{each.start:g} s: interrupted by {each.event}"
        for each in record.interruptions
        if each.event is not None and first_times.get(each.event, math.inf) > each.start
    ]
    if not record.result.success and not _may_fail_mission(record):
        texts.append(f"{record.result.duration:g} s: {record.result.verdict}")
    return tuple(texts)


def _may_fail(run: TaskRun, record: RunRecord) -> bool:
    """Return True if a fault may be the cause of a task's failure."""
    obstacles = {EventKind.POSITIVE_OBSTACLE, EventKind.NEGATIVE_OBSTACLE}
    blocked = any(a.kind in obstacles and a.t <= run.end for a in record.anomalies)
    for fault in record.faults:
        lasts = fault.start_time <= run.end and (
            fault.end_time is None or fault.end_time >= run.start
        )
        match fault:
            case DisplacedCheckpoint():
                if lasts and str(fault.checkpoint) == run.object_id:
                    return True
            case DriveDysfunction(speed=speed):
                # The drive fails after 30 s without any motion.
                if lasts and (speed or 0.0) < 0.01:
                    return True
            case SensorDysfunction(effect="fails"):
                if lasts and run.object_id is not None:
                    return True
            case Brick() | BlockedStairs() | MissingPlate():
                if blocked or record.drive == "tracked":
                    return True
    return False


def _may_fail_mission(record: RunRecord) -> bool:
    """Return True if findings or failures may be the cause of a mission's failure."""
    if any(run.outcome == "failed" for run in record.tasks):
        return True  # each failure must have its own cause
    verdict, handled = record.result.verdict, {r.event for r in record.mission.reactions}
    if record.result.outcome is None:
        if "battery was empty" in verdict:
            return any(isinstance(f, LowBattery | WornBattery) for f in record.faults)
        if "emergency stop" in verdict:
            now = record.result.duration
            return any(isinstance(f, EmergencyStop) and _is_present(f, now) for f in record.faults)
        return "stood still" in verdict and any(a.kind in handled for a in record.anomalies)
    aborted = record.result.outcome is not Outcome.COMPLETED
    return aborted and any(a.kind in handled for a in record.anomalies)


def _may_have_ended(record: RunRecord, number: int) -> bool:
    """Return True if a reported end follows the report of its beginning, and may be true."""
    anomaly = record.anomalies[number]
    before, now = record.anomalies[:number], anomaly.t
    begun = ENDS.get((anomaly.kind, anomaly.source))
    reported = [a.kind for a in before if a.source == anomaly.source]
    if begun is None or begun not in reported:
        return False
    faults = record.faults
    match anomaly.source:
        case "gas":
            return any(
                isinstance(f, GasLeakFault) and (f.end_time or math.inf) <= now for f in faults
            )
        case "alarm":
            return not any(isinstance(f, PlatformAlarm) and _is_present(f, now) for f in faults)
        case "connection":
            everywhere = [
                f
                for f in faults
                if isinstance(f, ConnectionLoss) and f.rect is None and f.floor is None
            ]
            return all(
                f.end_time is not None and f.end_time <= now
                for f in everywhere
                if f.start_time <= now
            )
        case _:
            near = min(record.path, key=lambda sample: abs(sample.t - now))
            return near.charge is not None and near.charge > 0.9


def _repeated_findings(record: RunRecord, site: Site) -> list[str]:
    """Return repeated findings of the watches that report each fault once."""
    texts = []
    for source in sorted(_REPORTED_ONCE):
        own = [a for a in record.anomalies if a.source == source and not a.is_end]
        for k, anomaly in enumerate(own):
            begun = {
                c.start_time for a in own[: k + 1] for c in find_causes(a, record.faults, site)
            }
            if k >= len(begun) > 0:
                texts.append(f"{anomaly.t:g} s: reported again: {anomaly.detail}")
    return texts


def _is_present(fault: AnyFault, now: float, lag: float = 0.0) -> bool:
    """Return True if a fault is present at `now` (s), or ended at most `lag` s before."""
    return fault.start_time <= now and (
        fault.end_time is None or now <= fault.end_time + lag + _STEP
    )


def _distance(place: Sequence[float] | None, other: Sequence[float]) -> float:
    assert place is not None
    return math.dist(place, other)
