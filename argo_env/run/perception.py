"""What the robot notices by itself: watches are called at their periods, and each thing is told
once, also when the run has been resumed meanwhile."""

import math
from collections.abc import Sequence

from argo_compiler.il import EventKind
from argo_env.navigation import Blockage
from argo_env.robot.pose import BodyPose
from argo_env.run.record import DIGITS, Anomaly, Reading, anomaly_from_reading
from argo_env.sensing.signals.terrain_watch import SAME_OBSTACLE, ObstacleDetection
from argo_env.sensing.watch import (
    Detection,
    ReportedDetection,
    RestorableWatch,
    SkippableWatch,
    Watch,
)
from argo_env.site import Site
from argo_env.site.shapes import Vector

OBSTACLES = frozenset({EventKind.POSITIVE_OBSTACLE, EventKind.NEGATIVE_OBSTACLE})
_AROUND = 0.25  # m about the place of an obstacle whose extent was not seen
_SAME_PLACE = 1.0  # m within which a watch finds the same again, after a run was resumed


class Perception:
    """Calls the watches of one run. Holds what was told before the run was resumed."""

    def __init__(self, watches: Sequence[Watch], site: Site, time_step: float) -> None:
        """`time_step` (s): how often it is asked."""
        self._site = site
        every = [max(1, round(watch.period / time_step)) for watch in watches]
        # Those of one period look in turn, not all in the same step.
        self._turns = [
            (watch, steps, k % steps)
            for k, (watch, steps) in enumerate(zip(watches, every, strict=True))
        ]
        self._patient = [w if isinstance(w, SkippableWatch) else None for w in watches]
        self._known: list[Anomaly] = []

    def remember(self, told: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """The run goes on at time `now` (s) after these have been told, with the robot at these
        poses; the watches are new."""
        self._known = [anomaly for anomaly, _ in told]
        for watch, _, _ in self._turns:
            if isinstance(watch, RestorableWatch):
                own = [
                    ReportedDetection(a.kind, pose) for a, pose in told if a.source == watch.name
                ]
                watch.restore(own, now)

    def look(self, step: int, now: float, pose: BodyPose) -> tuple[Anomaly, ...]:
        """What is found in the step of that number, at time `now` (s) with the robot at `pose`."""
        found = []
        for watch, every, turn in self._turns:
            if step % every == turn:
                for detection in watch.update(now, pose):
                    if not self._was_told(watch, detection):
                        found.append(self._anomaly(watch, detection, now))
        return tuple(found)

    def steps_to_look(self, first: int, last: int, charges: tuple[float, float]) -> set[int]:
        """The steps from the first to the last number in which anything may be noticed, if no fault
        begins or ends meanwhile and the charge of the battery is between these two (0 to 1)."""
        found: set[int] = set()
        for (_, every, turn), patient in zip(self._turns, self._patient, strict=True):
            if patient is None or not patient.can_skip(*charges):
                found.update(range(first + (turn - first) % every, last + 1, every))
        return found

    def _was_told(self, watch: Watch, detection: Detection) -> bool:
        if detection.place is None or isinstance(watch, RestorableWatch):
            return False
        for known in self._known:
            same = (known.kind, known.source) == (detection.kind, watch.name)
            if same and known.place and math.dist(known.place, detection.place) <= _SAME_PLACE:
                self._known.remove(known)
                return True
        return False

    def _anomaly(self, watch: Watch, detection: Detection, now: float) -> Anomaly:
        at = detection.place or detection.noticed_from
        return Anomaly(
            t=now,
            kind=detection.kind,
            detail=detection.detail,
            source=watch.name,
            place=None if detection.place is None else _rounded(detection.place),
            noticed_from=None
            if detection.noticed_from is None
            else _rounded(detection.noticed_from),
            floor=None if at is None else self._site.floor_at(at[2]),
            confidence=round(detection.confidence, DIGITS),
            extent=detection.blockage.rect if isinstance(detection, ObstacleDetection) else None,
        )


def blockage(anomaly: Anomaly) -> Blockage | None:
    """What an obstacle closes of the surface; None for all else.

    It may reach a little farther than was seen from the one side, without being told again.
    """
    if anomaly.kind not in OBSTACLES or anomaly.place is None:
        return None
    x, y, z = anomaly.place
    x0, y0, x1, y1 = anomaly.extent or (x, y, x, y)
    more = SAME_OBSTACLE if anomaly.extent else _AROUND
    return Blockage((x0 - more, y0 - more, x1 + more, y1 + more), z, anomaly.detail)


def abnormal_reading(reading: Reading, site: Site) -> Anomaly:
    """What a reading outside the checkpoint's nominal range tells."""
    return anomaly_from_reading(reading, _rounded(site.checkpoint(reading.checkpoint).position))


def _rounded(place: Vector) -> Vector:
    x, y, z = (round(v, DIGITS) for v in place)
    return x, y, z
