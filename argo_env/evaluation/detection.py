"""Whether the robot found what was wrong, and after how long."""

from argo_compiler.base.model import Model
from argo_env.evaluation.fault_signs import may_be_of
from argo_env.run.record import RunRecord
from argo_env.site import Site


class FaultDetection(Model):
    """A fault that happened, and when it was found."""

    fault: str
    """its kind"""
    began: float
    """s"""
    delay: float | None
    """s until it was found; None: it was not"""


def detections(record: RunRecord, site: Site) -> tuple[FaultDetection, ...]:
    """Of each fault of a run on the site that happened and can be found. Of several of one kind
    each finding stands for one, in the order of time; for faults of two kinds that show as the same
    in the same place it stands for both."""
    told: set[tuple[str, int]] = set()
    found = []
    happened = [f for f in record.faults if f.begins <= record.result.duration]
    for fault in sorted(happened, key=lambda one: one.begins):
        if fault.sign is None:
            continue
        delay = None
        for number, anomaly in enumerate(record.anomalies):
            new = (fault.kind, number) not in told
            if new and may_be_of(anomaly, fault, record, site):
                told.add((fault.kind, number))
                delay = round(anomaly.t - fault.begins, 3)
                break
        found.append(FaultDetection(fault=fault.kind, began=fault.begins, delay=delay))
    return tuple(found)
