"""Perception of the robot: watches are updated at their periods, and their detections reported.

Each anomaly is reported once, even if the run was resumed in between.
"""

import math
from collections.abc import Iterator, Sequence

from argo_compiler.base.wording import wording_of
from argo_compiler.il import EventKind
from argo_env.navigation import Blockage
from argo_env.robot.pose import BodyPose
from argo_env.run.record import DIGITS, Anomaly, Reading, anomaly_from_reading, ends
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

_LASTING = frozenset({EventKind.GAS_LEAK, EventKind.PLATFORM_ALARM})
"""dangers whose end a robot senses"""
OBSTACLES = frozenset({EventKind.POSITIVE_OBSTACLE, EventKind.NEGATIVE_OBSTACLE})
_AROUND = 0.25  # m around the position of an obstacle whose extent was not seen
_SAME_PLACE = 1.0  # m within which a detection is a known anomaly, after a run was resumed


class Perception:
    """Watches of one run, and the anomalies that were reported before the run was resumed."""

    def __init__(self, watches: Sequence[Watch], site: Site, time_step: float) -> None:
        """Take the watches; `update` is called after each `time_step` (s)."""
        self._site = site
        periods = [max(1, round(watch.period / time_step)) for watch in watches]
        # Watches of one period are updated in different steps, which spreads their cost.
        self._turns = [
            (watch, steps, k % steps)
            for k, (watch, steps) in enumerate(zip(watches, periods, strict=True))
        ]
        self._skippable = [w if isinstance(w, SkippableWatch) else None for w in watches]
        self._known: list[Anomaly] = []
        self.reaction: EventKind | None = None
        """event to which the mission reacts now; the run sets it"""
        self._dangers: dict[str, EventKind] = {}
        """lasting danger that each watch has found, without those that are over"""
        self._all_clears: dict[str, Detection] = {}
        """all-clear of each watch that is withheld"""

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """Restore the anomalies reported so far, for a run that continues with new watches.

        Args:
            reported: the anomalies, each with the robot's pose then.
            now: time at which the run continues in s.
        """
        self._known = [anomaly for anomaly, _ in reported]
        sources = {watch.name for watch, _, _ in self._turns}
        for anomaly in self._known:
            if anomaly.kind in _LASTING and anomaly.source in sources:
                self._dangers[anomaly.source] = anomaly.kind
            elif anomaly.kind is EventKind.ALL_CLEAR:
                self._dangers.pop(anomaly.source, None)
        for watch, _, _ in self._turns:
            if isinstance(watch, RestorableWatch):
                own = [
                    ReportedDetection(anomaly.kind, pose)
                    for anomaly, pose in reported
                    if anomaly.source == watch.name
                ]
                watch.restore(own, now)

    def update(self, step: int, now: float, pose: BodyPose) -> tuple[Anomaly, ...]:
        """Update the watches that are due in step number `step`, and return their new anomalies.

        Args:
            step: number of the time step since the run began.
            now: time in s.
            pose: pose of the robot.
        """
        found = []
        for watch, every, turn in self._turns:
            if step % every == turn:
                for detection in self._given(watch, watch.update(now, pose)):
                    if not self._was_reported(watch, detection):
                        found.append(self._anomaly(watch, detection, now))
        return tuple(found)

    def steps_with_updates(self, first: int, last: int, charges: tuple[float, float]) -> set[int]:
        """Return the numbers of a batch's steps in which an update may find or change anything.

        Args:
            first: number of the first step of a batch.
            last: number of its last step; no fault begins or ends in the batch.
            charges: lowest and highest charge of the battery in the batch, 0 to 1.
        """
        steps: set[int] = set()
        for (watch, every, turn), skippable in zip(self._turns, self._skippable, strict=True):
            if (
                skippable is None
                or watch.name in self._all_clears
                or not skippable.can_skip_updates(*charges)
            ):
                steps.update(range(first + (turn - first) % every, last + 1, every))
        return steps

    def _given(self, watch: Watch, detections: Sequence[Detection]) -> Iterator[Detection]:
        """Yield the new detections of a watch, but an all-clear only when it may be given."""
        for detection in detections:
            if detection.kind is EventKind.ALL_CLEAR:
                self._all_clears[watch.name] = detection
                continue
            if detection.kind in _LASTING:
                self._dangers[watch.name] = detection.kind
                self._all_clears.pop(watch.name, None)
            yield detection
        if watch.name in self._all_clears and self._may_give_all_clear(watch.name):
            self._dangers.pop(watch.name, None)
            yield self._all_clears.pop(watch.name)

    def _may_give_all_clear(self, source: str) -> bool:
        """Return True if no other danger goes on, or the mission reacts to that which is over.

        An all-clear ends the mission's wait, so that of another danger would be a false one.
        """
        if self.reaction is not None and ends(EventKind.ALL_CLEAR, self.reaction):
            return self._dangers.get(source, self.reaction) is self.reaction
        return all(other == source or other in self._all_clears for other in self._dangers)

    def _was_reported(self, watch: Watch, detection: Detection) -> bool:
        """Return True if the detection is an anomaly that was reported before the run was resumed.

        This removes the anomaly from those that are known: a second detection gives False.
        """
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
            detail_wording=wording_of(detection.detail),
            source=watch.name,
            place=None if detection.place is None else _rounded(detection.place),
            noticed_from=None
            if detection.noticed_from is None
            else _rounded(detection.noticed_from),
            floor=None if at is None else self._site.floor_at(at[2]),
            confidence=round(detection.confidence, DIGITS),
            extent=detection.blockage.rect if isinstance(detection, ObstacleDetection) else None,
        )


def blockage_from_anomaly(anomaly: Anomaly) -> Blockage | None:
    """Return the part of the surface that an obstacle closes.

    None if the anomaly is no obstacle, or has no position. The part is a little larger than what
    was seen: the obstacle may reach farther than it seemed from one side, and that will not be
    reported.
    """
    if anomaly.kind not in OBSTACLES or anomaly.place is None:
        return None
    x, y, z = anomaly.place
    x0, y0, x1, y1 = anomaly.extent or (x, y, x, y)
    more = SAME_OBSTACLE if anomaly.extent else _AROUND
    return Blockage((x0 - more, y0 - more, x1 + more, y1 + more), z, anomaly.detail)


def anomaly_at_checkpoint(abnormal_reading: Reading, site: Site) -> Anomaly:
    """Return the anomaly of an abnormal reading, at the position of its checkpoint."""
    return anomaly_from_reading(
        abnormal_reading, _rounded(site.checkpoint(abnormal_reading.checkpoint).position)
    )


def _rounded(position: Vector) -> Vector:
    x, y, z = (round(v, DIGITS) for v in position)
    return x, y, z
