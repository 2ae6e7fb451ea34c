"""Detected faults of a run with their delays, and its false alarms."""

from collections.abc import Callable
from dataclasses import dataclass

from argo_compiler.base.model import Model
from argo_compiler.hfsm.charging import LOW
from argo_compiler.il import EventKind
from argo_env.drives.battery import ESTIMATE_ERROR
from argo_env.faults.kinds import AnyFault
from argo_env.run.causes import false_all_clears, may_be_caused_by
from argo_env.run.record import Finding, RunRecord
from argo_env.run.run_setup import displayed_value, true_values
from argo_env.run.spec import RunSpec, ValueProfile
from argo_env.site import Site


class FaultDetection(Model):
    """Fault that occurred in a run, with the delay until the robot found it."""

    fault: str
    """kind of the fault"""
    began: float
    """s"""
    delay: float | None
    """s until the robot found it; None if it did not"""


def detections(record: RunRecord, site: Site) -> tuple[FaultDetection, ...]:
    """Return each fault that occurred in a run on the site and can be found, with its delay.

    A fault that the robot did not find has no delay. Among faults of one kind, each anomaly counts
    for one fault only, in the order of time. It counts for faults of two kinds if both lead to the
    same kind of anomaly (`Fault.sign`) at the same location.
    """
    assigned: set[tuple[str, int]] = set()
    found = []
    occurred = [f for f in record.faults if f.start_time <= record.result.duration]
    for fault in sorted(occurred, key=lambda one: one.start_time):
        if fault.sign is None:
            continue
        delay = None
        for number, anomaly in enumerate(record.anomalies):
            is_free = (fault.kind, number) not in assigned
            if is_free and may_be_caused_by(anomaly, fault, record, site):
                assigned.add((fault.kind, number))
                delay = round(anomaly.t - fault.start_time, 3)
                break
        found.append(FaultDetection(fault=fault.kind, began=fault.start_time, delay=delay))
    return tuple(found)


_SLOW = 0.7
"""share of its speed below which the robot may report its drive as faulty (docs/faults.md)"""
_NEARBY = 1.0  # s, largest time between a finding and the samples of the path that show its charge


@dataclass(frozen=True)
class _GroundTruth:
    """Run with the true state of its world, to which its findings are compared."""

    record: RunRecord
    spec: RunSpec
    site: Site

    def was_abnormal(self, finding: Finding) -> bool:
        """Return True if the finding's checkpoint had an abnormal value in this world anyway.

        That is a value outside the checkpoint's nominal range that is not due to a fault.
        """
        reading = self.record.abnormal_reading(finding)
        if reading is None:
            return False
        checkpoint = self.site.checkpoint(reading.checkpoint)
        first = true_values(self.site, self.spec.seed, self.spec.values)[checkpoint.id]
        profile = self.spec.conditions.values.get(checkpoint.id, ValueProfile())
        shown = displayed_value(checkpoint, first, profile, self.spec.seed, finding.t)
        return not checkpoint.nominal.contains(shown)

    def was_low(self, finding: Finding) -> bool:
        """Return True if the battery's charge was as low as reported, within its estimate error."""
        charges = [
            sample.charge
            for sample in self.record.path
            if sample.charge is not None and abs(sample.t - finding.t) <= _NEARBY
        ]
        reactions = self.record.mission.reactions
        level = next((r.battery_below for r in reactions if r.battery_below), LOW)
        return bool(charges) and min(charges) <= level + ESTIMATE_ERROR

    def was_out_of_order(self, finding: Finding) -> bool:
        """Return True if the drive was too slow, or the camera noisy, as the finding reports."""
        conditions = self.spec.conditions
        if finding.source == "drive":
            return conditions.speed < _SLOW
        return finding.source == "camera" and conditions.sensor_noise > 0

    def is_caused_by(self, finding: Finding, fault: AnyFault) -> bool:
        """Return True if the fault may be the cause; a camera fault may cause any reading."""
        if may_be_caused_by(finding, fault, self.record, self.site):
            return True
        # A faulty camera may misread any value.
        may_misread = finding.is_reading and fault.kind == "sensor_dysfunction"
        return may_misread and fault.start_time <= finding.t


_TRUE_WITHOUT_FAULT: dict[EventKind, Callable[[_GroundTruth, Finding], bool]] = {
    EventKind.ABNORMAL_READING: _GroundTruth.was_abnormal,
    EventKind.LOW_BATTERY: _GroundTruth.was_low,
    EventKind.DYSFUNCTION: _GroundTruth.was_out_of_order,
}
"""tests of findings that may be true without any fault, as each world has its own values, battery
charge, drive speed and camera noise"""


def false_alarms(record: RunRecord, spec: RunSpec, site: Site) -> int:
    """Return the number of false findings and all-clears of the run of a spec on its site.

    A finding is false if no fault that had begun can be its cause, and the values, the battery, the
    drive and the camera of this world were not as the finding states. `false_all_clears` states
    which all-clears are false. Reports that a person gave the robot don't count, as they are not
    its own.
    """
    truth = _GroundTruth(record, spec, site)

    def is_true(finding: Finding) -> bool:
        if any(truth.is_caused_by(finding, fault) for fault in record.faults):
            return True
        return finding.kind in _TRUE_WITHOUT_FAULT and _TRUE_WITHOUT_FAULT[finding.kind](
            truth, finding
        )

    false_findings = sum(
        not (finding.is_reported_from_outside or is_true(finding)) for finding in record.findings
    )
    return false_findings + len(false_all_clears(record, site))
