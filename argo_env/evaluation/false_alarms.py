"""False alarms: what a run found and was not so, neither by a fault nor by its world."""

from collections.abc import Callable
from dataclasses import dataclass

from argo_compiler.il import EventKind
from argo_env.drives.battery import ESTIMATE_ERROR
from argo_env.evaluation.fault_signs import may_be_of, reading_of
from argo_env.faults.kinds import AnyFault
from argo_env.run.conditions import ValueProfile
from argo_env.run.instruments import shown_at
from argo_env.run.record import Finding, RunRecord
from argo_env.run.rig import true_values
from argo_env.run.spec import RunSpec
from argo_env.sensing.onboard import LOW
from argo_env.site import Site

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
        shown = shown_at(checkpoint, first, profile, self.spec.seed, finding.t)
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

    return sum(not (finding.is_told or was_so(finding)) for finding in record.findings)
