"""Causes of what the robot found in a run, among the run's faults, which the robot did not know."""

from argo_compiler.il import EventKind
from argo_env.faults.checkpoints import AbnormalValue
from argo_env.faults.kinds import AnyFault
from argo_env.formatting import min_sec_text
from argo_env.run.record import Anomaly, RunRecord
from argo_env.site import Site


def may_be_caused_by(anomaly: Anomaly, fault: AnyFault, record: RunRecord, site: Site) -> bool:
    """Return True if this fault of the run may be the cause of the anomaly that the robot found.

    The anomaly must match the fault's kind, its time, and its location as far as the anomaly has
    one.
    """
    sign = fault.sign
    if sign is None or (anomaly.kind, anomaly.source) != (sign.event, sign.source):
        return False
    if anomaly.t < fault.start_time or (
        fault.end_time is not None and anomaly.t > fault.end_time + sign.outlasts
    ):
        return False
    if isinstance(fault, AbnormalValue):
        reading = record.abnormal_reading(anomaly)
        return reading is not None and reading.checkpoint == fault.checkpoint
    return fault.can_explain(anomaly.place, anomaly.noticed_from, site)


def false_all_clears(record: RunRecord, site: Site) -> tuple[Anomaly, ...]:
    """Return the all-clears that the robot gave although what it had found went on.

    An all-clear is false if it ends a finding that has causes among the faults of the run, of which
    none had ended. A person's all-clear is not the robot's.
    """

    def goes_on(finding: Anomaly, now: float) -> bool:
        causes = [f for f in record.faults if may_be_caused_by(finding, f, record, site)]
        return bool(causes) and all(f.end_time is None or f.end_time > now for f in causes)

    return tuple(
        end
        for end in record.anomalies
        if end.kind is EventKind.ALL_CLEAR
        and not end.is_reported_from_outside
        and any(
            finding.over_at == end.t and end.is_end_of(finding) and goes_on(finding, end.t)
            for finding in record.findings
        )
    )


def explain_false_all_clear(all_clear: Anomaly) -> str:
    """Return a text that says that an all-clear of the robot was false."""
    found_by = {"gas": "the gas leak went on", "alarm": "the alarm went on"}
    why = found_by.get(all_clear.source, "what it ended went on")
    return f"the all-clear at {min_sec_text(all_clear.t)} was false: {why}"
