"""What a fault may lead to, written from docs/faults.md and docs/signals.md and not from the code:
whatever a run found, failed at or gave up must have a cause among the faults that it had."""

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

_STEP = 0.11  # s: a time step of a drive, in which what begins and ends is noticed
_GAS_STAYS = 120.0  # s in which gas that has escaped disperses
_GAS_REACHES = 25.0  # m
_SPOT_OFF = 2.5  # m that a hot spot's place may be wrong
_BESIDE = 0.35  # m beside an obstacle, or the edge of a hole, that may be taken for it
_SLOW = 0.7  # share of its speed below which a drive may be found out of order: 0.6, as measured
_DRIVE_LOOKS_BACK = 10.0 + 1.0  # s, the window of the drive's watch and its period

_OBSTACLES = (Brick, BlockedStairs, MissingPlate)


@dataclass(frozen=True)
class FaultCause:
    """A kind of fault as the cause of a finding."""

    fault: type[Fault]
    lag: float = 0.0
    """s after its end in which it may still be found"""
    fits: Callable[[AnyFault, Anomaly, Site], bool] = lambda *_: True
    """whether the finding says what that fault shows"""


def _same_checkpoint(fault: AnyFault, anomaly: Anomaly, site: Site) -> bool:
    assert isinstance(fault, AbnormalValue)
    assert fault.checkpoint is not None
    return anomaly.detail.startswith(f"{site.checkpoint(fault.checkpoint).name} shows ")


def _noisy(fault: AnyFault, _: Anomaly, __: Site) -> bool:
    return isinstance(fault, SensorDysfunction) and fault.effect == "noise"


def _gas_gets_there(fault: AnyFault, anomaly: Anomaly, _: Site) -> bool:
    assert isinstance(fault, GasLeakFault)
    at = anomaly.noticed_from
    return at is not None and _apart(fault.place, at) <= _GAS_REACHES


def _glows_there(fault: AnyFault, anomaly: Anomaly, _: Site) -> bool:
    assert isinstance(fault, HotSpotFault)
    return anomaly.place is not None and _apart(fault.place, anomaly.place) <= _SPOT_OFF


def _that_pump(fault: AnyFault, anomaly: Anomaly, _: Site) -> bool:
    assert isinstance(fault, AbnormalPump)
    return anomaly.detail.startswith(f"{fault.pump} sounds ")


def _stands_there(fault: AnyFault, anomaly: Anomaly, site: Site) -> bool:
    before = {element.name for element in site.elements}
    added = [e for e in fault.changed_elements(site) if e.name not in before]
    place = anomaly.place
    return place is not None and any(
        isinstance(solid, Box)
        and math.dist(solid.center[:2], place[:2]) <= math.hypot(*solid.size[:2]) / 2 + _BESIDE
        and abs(solid.center[2] - solid.size[2] / 2 - place[2]) <= _BESIDE
        for element in added
        for solid in element.solids
    )


def _is_missing_there(fault: AnyFault, anomaly: Anomaly, site: Site) -> bool:
    assert isinstance(fault, MissingPlate)
    assert fault.rect is not None
    if anomaly.place is None or site.floor_at(anomaly.place[2]) != fault.floor:
        return False
    (x, y, _), (x0, y0, x1, y1) = anomaly.place, fault.rect
    return x0 - _BESIDE <= x <= x1 + _BESIDE and y0 - _BESIDE <= y <= y1 + _BESIDE


def _slow(fault: AnyFault, _: Anomaly, __: Site) -> bool:
    return isinstance(fault, DriveDysfunction) and (fault.speed or 0.0) < _SLOW


CAUSES: dict[tuple[EventKind, str], tuple[FaultCause, ...]] = {
    (EventKind.ABNORMAL_READING, FROM_READING): (
        FaultCause(AbnormalValue, fits=_same_checkpoint),
        FaultCause(SensorDysfunction, fits=_noisy),
    ),
    (EventKind.GAS_LEAK, "gas"): (FaultCause(GasLeakFault, _GAS_STAYS, _gas_gets_there),),
    (EventKind.HOT_SPOT, "heat"): (FaultCause(HotSpotFault, fits=_glows_there),),
    (EventKind.ABNORMAL_SOUND, "pumps"): (FaultCause(AbnormalPump, fits=_that_pump),),
    (EventKind.PLATFORM_ALARM, "alarm"): (FaultCause(PlatformAlarm),),
    (EventKind.POSITIVE_OBSTACLE, "terrain"): (
        FaultCause(Brick, fits=_stands_there), FaultCause(BlockedStairs, fits=_stands_there),
    ),
    (EventKind.NEGATIVE_OBSTACLE, "terrain"): (FaultCause(MissingPlate, fits=_is_missing_there),),
    (EventKind.LOW_BATTERY, "battery"): (FaultCause(LowBattery), FaultCause(WornBattery)),
    (EventKind.CONNECTION_LOST, "connection"): (FaultCause(ConnectionLoss),),
    (EventKind.EMERGENCY_STOP, "emergency stop"): (FaultCause(EmergencyStop),),
    (EventKind.DYSFUNCTION, "camera"): (FaultCause(SensorDysfunction),),
    (EventKind.DYSFUNCTION, "drive"): (FaultCause(DriveDysfunction, _DRIVE_LOOKS_BACK, _slow),),
}  # fmt: skip
"""By the kind of a finding and the watch that tells it: the faults that may be its cause."""

ENDS: dict[tuple[EventKind, str], EventKind] = {
    (EventKind.ALL_CLEAR, "gas"): EventKind.GAS_LEAK,
    (EventKind.ALL_CLEAR, "alarm"): EventKind.PLATFORM_ALARM,
    (EventKind.BATTERY_CHARGED, "battery"): EventKind.LOW_BATTERY,
    (EventKind.CONNECTION_RESTORED, "connection"): EventKind.CONNECTION_LOST,
}
"""What tells that something is over, and the finding that must have come before."""

_TOLD_ONCE = frozenset({"emergency stop", "camera", "drive", "alarm"})
"""the watches that tell each fault once while it lasts, wherever the robot is"""


def causes_of(anomaly: Anomaly, faults: Sequence[AnyFault], site: Site) -> tuple[AnyFault, ...]:
    """The faults that may have led to a finding."""
    return tuple(
        fault
        for cause in CAUSES.get((anomaly.kind, anomaly.source), ())
        for fault in faults
        if isinstance(fault, cause.fault)
        and _there(fault, anomaly.t, cause.lag)
        and cause.fits(fault, anomaly, site)
    )


def without_cause(record: RunRecord, site: Site) -> tuple[str, ...]:
    """What a run on the site found, told as over, touched or failed at for no reason."""
    said = [
        f"{a.t:g} s: {a.kind} ({a.source}): {a.detail}"
        for k, a in enumerate(record.anomalies)
        if not (_was_over(record, k) if a.is_end else causes_of(a, record.faults, site))
    ]
    said += _told_again(record, site)
    if not any(isinstance(fault, _OBSTACLES) for fault in record.faults):
        said += [f"{c.start:g} s: {c.link} touches {c.element}" for c in record.contacts]
        said += [f"{m.t:g} s: {m.trouble}: {m.detail}" for m in record.mishaps]
    return tuple(said)


def given_up_without_cause(record: RunRecord) -> tuple[str, ...]:
    """What became of the mission for no reason: tasks that failed, interruptions, its end."""
    said = [
        f"{run.end:g} s: task {run.task} failed: {run.reason}"
        for run in record.tasks
        if run.outcome == "failed" and not _may_fail(run, record)
    ]
    found = {a.kind: a.t for a in reversed(record.anomalies)}
    said += [
        f"{each.start:g} s: interrupted by {each.event}"
        for each in record.interruptions
        if each.event is not None and found.get(each.event, math.inf) > each.start
    ]
    if not record.result.success and not _may_end_so(record):
        said.append(f"{record.result.duration:g} s: {record.result.verdict}")
    return tuple(said)


def _may_fail(run: TaskRun, record: RunRecord) -> bool:
    """Whether a fault may be why a task failed."""
    obstacles = {EventKind.POSITIVE_OBSTACLE, EventKind.NEGATIVE_OBSTACLE}
    in_the_way = any(a.kind in obstacles and a.t <= run.end for a in record.anomalies)
    for fault in record.faults:
        lasts = fault.start_time <= run.end and (
            fault.end_time is None or fault.end_time >= run.start
        )
        match fault:
            case DisplacedCheckpoint():
                if lasts and str(fault.checkpoint) == run.object_id:
                    return True
            case DriveDysfunction(speed=speed):
                # It is given up after 30 s without any motion.
                if lasts and (speed or 0.0) < 0.01:
                    return True
            case SensorDysfunction(effect="fails"):
                if lasts and run.object_id is not None:
                    return True
            case Brick() | BlockedStairs() | MissingPlate():
                if in_the_way or record.drive == "tracked":
                    return True
    return False


def _may_end_so(record: RunRecord) -> bool:
    """Whether a mission without success ended as its findings and failures may let it."""
    if any(run.outcome == "failed" for run in record.tasks):
        return True  # which must have causes of their own
    verdict, answered = record.result.verdict, {r.event for r in record.mission.reactions}
    if record.result.outcome is None:
        if "battery was empty" in verdict:
            return any(isinstance(f, LowBattery | WornBattery) for f in record.faults)
        if "emergency stop" in verdict:
            now = record.result.duration
            return any(isinstance(f, EmergencyStop) and _there(f, now) for f in record.faults)
        return "stands still" in verdict and any(a.kind in answered for a in record.anomalies)
    given_up = record.result.outcome is not Outcome.COMPLETED
    return given_up and any(a.kind in answered for a in record.anomalies)


def _was_over(record: RunRecord, number: int) -> bool:
    """Whether what an anomaly tells to be over had been told, and may be over."""
    anomaly = record.anomalies[number]
    before, now = record.anomalies[:number], anomaly.t
    begun = ENDS.get((anomaly.kind, anomaly.source))
    told = [a.kind for a in before if a.source == anomaly.source]
    if begun is None or begun not in told:
        return False
    faults = record.faults
    match anomaly.source:
        case "gas":
            return any(
                isinstance(f, GasLeakFault) and (f.end_time or math.inf) <= now for f in faults
            )
        case "alarm":
            return not any(isinstance(f, PlatformAlarm) and _there(f, now) for f in faults)
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


def _told_again(record: RunRecord, site: Site) -> list[str]:
    """Findings of the robot itself, more than there were faults to lead to them."""
    said = []
    for source in sorted(_TOLD_ONCE):
        own = [a for a in record.anomalies if a.source == source and not a.is_end]
        for k, anomaly in enumerate(own):
            begun = {c.start_time for a in own[: k + 1] for c in causes_of(a, record.faults, site)}
            if k >= len(begun) > 0:
                said.append(f"{anomaly.t:g} s: told again: {anomaly.detail}")
    return said


def _there(fault: AnyFault, now: float, lag: float = 0.0) -> bool:
    """Whether a fault is there at `now` (s), or ended at most `lag` s ago."""
    return fault.start_time <= now and (
        fault.end_time is None or now <= fault.end_time + lag + _STEP
    )


def _apart(place: Sequence[float] | None, other: Sequence[float]) -> float:
    assert place is not None
    return math.dist(place, other)
