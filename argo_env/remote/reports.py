"""From what a robot reports to what goes into the record."""

import math

from argo_compiler.il import Task
from argo_env.remote.messages import EndReport, FoundReport
from argo_env.robot.pose import BodyPose
from argo_env.run.record import DIGITS, Anomaly, Reading
from argo_env.site import Site


def anomaly_of(report: FoundReport, site: Site, pose: BodyPose, now: float) -> Anomaly:
    """What the robot has noticed, at time `now` (s) and `pose`."""
    here = (round(pose.x, DIGITS), round(pose.y, DIGITS), round(pose.z, DIGITS))
    place = report.place
    return Anomaly(
        t=now,
        kind=report.event,
        detail=report.detail,
        source="robot",
        place=place,
        noticed_from=None if place else here,
        floor=site.floor_at((place or here)[2]),
    )


def reading_of(
    task: Task, ended: EndReport, site: Site, pose: BodyPose, now: float
) -> Reading | None:
    """What was measured, at time `now` (s) and `pose`; None: nothing was. A distance that the robot
    did not tell is that from its origin."""
    if ended.outcome != "done" or ended.value is None or task.object_id is None:
        return None
    checkpoint = site.measured_by(task.object_id)
    away = math.dist(checkpoint.position, (pose.x, pose.y, pose.z))
    return Reading(
        checkpoint=checkpoint.id,
        name=checkpoint.name,
        kind=checkpoint.kind,
        floor=checkpoint.floor,
        task=task.name,
        t=now,
        value=ended.value,
        unit=checkpoint.unit,
        nominal=checkpoint.nominal,
        normal=checkpoint.nominal.contains(ended.value),
        distance=round(away if ended.distance is None else ended.distance, DIGITS),
        confidence=round(ended.confidence, DIGITS),
    )
