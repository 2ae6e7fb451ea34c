"""Whether the robot found what was wrong, and after how long."""

from argo_compiler.il import EventKind
from argo_compiler.model import Model
from argo_env.faults.kinds import AnyFault
from argo_env.run.record import FROM_READING, Anomaly, RunRecord

_FOUND_AS: dict[str, tuple[EventKind, str | None]] = {
    "abnormal_value": (EventKind.ABNORMAL_READING, FROM_READING),
    "gas_leak": (EventKind.GAS_LEAK, None),
    "hot_spot": (EventKind.HOT_SPOT, None),
    "abnormal_pump": (EventKind.ABNORMAL_SOUND, None),
    "platform_alarm": (EventKind.PLATFORM_ALARM, None),
    "brick": (EventKind.POSITIVE_OBSTACLE, None),
    "blocked_stairs": (EventKind.POSITIVE_OBSTACLE, None),
    "missing_plate": (EventKind.NEGATIVE_OBSTACLE, None),
    "low_battery": (EventKind.LOW_BATTERY, None),
    "worn_battery": (EventKind.LOW_BATTERY, None),
    "connection_loss": (EventKind.CONNECTION_LOST, None),
    "emergency_stop": (EventKind.EMERGENCY_STOP, None),
    "sensor_dysfunction": (EventKind.DYSFUNCTION, "camera"),
    "drive_dysfunction": (EventKind.DYSFUNCTION, "drive"),
}
"""By the kind of a fault: as what it is found, and by which watch (None: any). A checkpoint that
was moved is found by nothing: it is read all the same."""


class FaultDetection(Model):
    """A fault that happened, and when it was found."""

    fault: str
    """its kind"""
    began: float
    """s"""
    delay: float | None
    """s until it was found; None: it was not"""


def detections(record: RunRecord) -> tuple[FaultDetection, ...]:
    """Of each fault that happened and can be found. Of several of one kind each finding stands for
    one, in the order of time; for faults of two kinds that show as the same it stands for both."""
    told: set[tuple[str, int]] = set()
    found = []
    happened = [f for f in record.faults if f.begins <= record.result.duration]
    for fault in sorted(happened, key=lambda one: one.begins):
        if fault.kind not in _FOUND_AS:
            continue
        delay = None
        for number, anomaly in enumerate(record.anomalies):
            if _tells(anomaly, fault) and (fault.kind, number) not in told:
                told.add((fault.kind, number))
                delay = round(anomaly.t - fault.begins, 3)
                break
        found.append(FaultDetection(fault=fault.kind, began=fault.begins, delay=delay))
    return tuple(found)


def false_alarms(record: RunRecord) -> int:
    """How many findings no fault of the run accounts for. That a value is abnormal is one if no
    fault made a value abnormal, or the sensor unsure."""
    kinds = {_FOUND_AS[f.kind][0] for f in record.faults if f.kind in _FOUND_AS}
    if any(f.kind == "sensor_dysfunction" for f in record.faults):
        kinds.add(EventKind.ABNORMAL_READING)
    return sum(
        finding.kind not in kinds and finding.source != "told" for finding in record.findings
    )


def _tells(anomaly: Anomaly, fault: AnyFault) -> bool:
    kind, source = _FOUND_AS[fault.kind]
    return (
        anomaly.kind is kind
        and (source is None or anomaly.source == source)
        and anomaly.t >= fault.begins
    )
