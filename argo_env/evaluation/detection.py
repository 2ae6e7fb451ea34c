"""Detections of what was wrong, with their delays, and false alarms."""

from collections.abc import Callable
from dataclasses import dataclass

from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.drives.battery import ESTIMATE_ERROR
from argo_env.faults.checkpoints import AbnormalValue
from argo_env.faults.kinds import AnyFault
from argo_env.run.record import Anomaly, Finding, Reading, RunRecord
from argo_env.run.run_setup import displayed_value, true_values
from argo_env.run.spec import RunSpec, ValueProfile
from argo_env.sensing.onboard import LOW
from argo_env.site import Site


def may_be_of(anomaly: Anomaly, fault: AnyFault, record: RunRecord, site: Site) -> bool:
    """Whether what the robot found in a run on the site may be this fault of the run: of its kind,
    while it lasted, and where it is, as far as the finding tells a place."""
    sign = fault.sign
    if sign is None or (anomaly.kind, anomaly.source) != (sign.event, sign.source):
        return False
    if anomaly.t < fault.begins or (
        fault.ends is not None and anomaly.t > fault.ends + sign.outlasts
    ):
        return False
    if isinstance(fault, AbnormalValue):
        reading = reading_of(anomaly, record)
        return reading is not None and reading.checkpoint == fault.checkpoint
    return fault.is_at(anomaly.place, anomaly.noticed_from, site)


def reading_of(anomaly: Anomaly, record: RunRecord) -> Reading | None:
    """The reading that an abnormal value was found by; None for what was found otherwise."""
    if not anomaly.is_reading:
        return None
    return next((reading for reading in record.readings if reading.t == anomaly.t), None)


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


_SLOW = 0.7
"""share of its speed below which a drive may be found out of order (docs/faults.md)"""
_BESIDE = 1.0  # s between a finding and the places of the path that tell its charge


@dataclass(frozen=True)
class _TrueWorld:
    """A run, and what was so in its world."""

    record: RunRecord
    spec: RunSpec
    site: Site

    def was_abnormal(self, finding: Finding) -> bool:
        """Whether the checkpoint showed a value outside its nominal range."""
        reading = reading_of(finding, self.record)
        if reading is None:
            return False
        checkpoint = self.site.checkpoint(reading.checkpoint)
        first = true_values(self.site, self.spec.seed, self.spec.values)[checkpoint.id]
        profile = self.spec.conditions.values.get(checkpoint.id, ValueProfile())
        shown = displayed_value(checkpoint, first, profile, self.spec.seed, finding.t)
        return not checkpoint.nominal.contains(shown)

    def was_low(self, finding: Finding) -> bool:
        """Whether the battery had as little charge as the robot found."""
        charges = [
            sample.charge
            for sample in self.record.path
            if sample.charge is not None and abs(sample.t - finding.t) <= _BESIDE
        ]
        reactions = self.record.mission.reactions
        level = next((r.battery_below for r in reactions if r.battery_below), LOW)
        return bool(charges) and min(charges) <= level + ESTIMATE_ERROR

    def was_out_of_order(self, finding: Finding) -> bool:
        """Whether the drive was slower, or the camera noisier, than it should be."""
        conditions = self.spec.conditions
        if finding.source == "drive":
            return conditions.speed < _SLOW
        return finding.source == "camera" and conditions.sensor_noise > 0

    def is_of(self, finding: Finding, fault: AnyFault) -> bool:
        """Whether the fault may be why that was found."""
        if may_be_of(finding, fault, self.record, self.site):
            return True
        # A camera that is out of order takes any value for another.
        unsure = finding.is_reading and fault.kind == "sensor_dysfunction"
        return unsure and fault.begins <= finding.t


_TRUE: dict[EventKind, Callable[[_TrueWorld, Finding], bool]] = {
    EventKind.ABNORMAL_READING: _TrueWorld.was_abnormal,
    EventKind.LOW_BATTERY: _TrueWorld.was_low,
    EventKind.DYSFUNCTION: _TrueWorld.was_out_of_order,
}
"""What may be so without any fault: values, charge, speed and noise are the world's own."""


def false_alarms(record: RunRecord, spec: RunSpec, site: Site) -> int:
    """How many findings of the run of a spec, on its site, were not so: no fault that had begun
    shows as that, and neither values nor battery, drive or camera were as found. What the robot was
    told by somebody is no finding of its own."""
    world = _TrueWorld(record, spec, site)

    def was_so(finding: Finding) -> bool:
        if any(world.is_of(finding, fault) for fault in record.faults):
            return True
        return finding.kind in _TRUE and _TRUE[finding.kind](world, finding)

    return sum(not (finding.is_reported or was_so(finding)) for finding in record.findings)
