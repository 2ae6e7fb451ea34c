"""As what faults show: which findings of a run may be of which fault."""

from argo_env.faults.checkpoints import AbnormalValue
from argo_env.faults.kinds import AnyFault
from argo_env.run.record import Anomaly, Reading, RunRecord
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
