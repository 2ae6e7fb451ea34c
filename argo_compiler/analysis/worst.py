"""What a mission takes at most, whatever fails and whatever occurs: reactions included.

It is assumed that nobody interrupts the mission or takes the robot over, that an action which fails
has failed by the time at which it would have been done, and that after actions which failed or were
cancelled, be it several in a row, the robot is between two places of the plan of which one follows
the other.
"""

import math

from argo_compiler.analysis.bounds import longest
from argo_compiler.analysis.facts import Bound
from argo_compiler.analysis.legs import Legs
from argo_compiler.analysis.levels import BoundsTooLargeError
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.travel import NoWay, Standing
from argo_compiler.il import Action, Afterwards, EventKind, Mode, Reaction, Response, Task

_MOST_LEAVES = 2_000
"""of missions that are looked at"""


def worst_duration(study: Study) -> Bound | None:
    """A bound of the duration (s) over all runs; None if that was not looked at."""
    if study.travel is None or len(study.flow.leaves) > _MOST_LEAVES:
        return None
    legs = Legs(study.flow, study.with_failures, study.travel, study.mission)
    if legs.blocked or legs.too_many:
        return None
    try:
        within = longest(study.flow, study.with_failures, legs)
    except BoundsTooLargeError:
        return None
    if study.extent is not None and study.extent.duration is not None:
        within = max(within, study.extent.duration.most.value or 0.0)
    reactions = _Reactions(study, legs)
    return Bound(value=_finite(min(within + reactions.after_any(), reactions.after_time_up())))


def _finite(seconds: float) -> float | None:
    return seconds if math.isfinite(seconds) else None


class _Reactions:
    """How long reactions go on. A reaction that ends the mission lets nothing else go on after it,
    so that each of them is carried out once at most."""

    def __init__(self, study: Study, legs: Legs) -> None:
        assert study.travel is not None
        self.study = study
        self.legs = legs
        self.travel = study.travel
        self.clean_up = study.travel.clean_up
        self._start = study.travel.start(study.mission)
        self.mission = study.mission
        self.reactions = [r for r in study.mission.reactions if r.response is not Response.REPORT]

    def after_any(self) -> float:
        """s at most that reactions add to the mission; infinite if one may interrupt it at will."""
        if self.mission.mode is Mode.SUPERVISORY:
            return math.inf
        return sum(map(self._ending, self.reactions))

    def after_time_up(self) -> float:
        """s at most until the mission has ended as its time is up; infinite if it goes on."""
        limit = self.mission.max_duration
        last = next((r for r in self.reactions if r.event is EventKind.TIME_UP), None)
        if limit is None or last is None or self.mission.mode is Mode.SUPERVISORY:
            return math.inf
        if any(map(_may_pause, self.reactions)):
            return math.inf
        # A reaction of the same rank may be under way when the time is up.
        return limit + sum(self._ending(r) for r in self.reactions if r.rank >= last.rank)

    def _ending(self, reaction: Reaction) -> float:
        """s from a reaction's event until the mission has ended; infinite if it need not end."""
        if reaction.response is Response.ABORT:
            return self.clean_up
        held = 0.0
        if reaction.holds:
            held = math.inf if reaction.hold_limit is None else reaction.hold_limit
        if reaction.response is Response.PAUSE:
            ends = reaction.until is None and reaction.on_limit is Afterwards.END
            return self.clean_up + held if ends else math.inf
        if reaction.afterwards is not Afterwards.END or _may_pause(reaction):
            return math.inf
        return self.clean_up + self._drive(reaction) + held

    def _drive(self, reaction: Reaction) -> float:
        """s at most to where a reaction sends the robot, from wherever it is."""
        target = self._target(reaction)
        others = [self._target(r) for r in self.reactions if r.response.drives]
        ways = [self._longest_way(target)]
        for other in others:
            if other != target:
                ways.append(self._longest_way(other) + self._leg(self._standing(other), target))
                ways.append(self._way_past_leaves(other, target))
        return max(ways)

    def _target(self, reaction: Reaction) -> Task:
        pose = reaction.pose
        if reaction.response is Response.RETURN and pose is None:
            pose = self.mission.dock
        return Task(name="drive", action=Action.WAYPOINT, pose=pose)

    def _longest_way(self, target: Task) -> float:
        """From wherever the plan brings the robot."""
        longest = self._leg(self._start, target)
        for leaf, places in enumerate(self.legs.places):
            if places:
                way = self.legs.way_back(leaf, target)
                longest = max(longest, math.inf if isinstance(way, NoWay) else way.time.most)
        return longest

    def _way_past_leaves(self, other: Task, target: Task) -> float:
        """From wherever it is on the way back from another reaction's place to the plan's."""
        longest = 0.0
        standing = self._standing(other)
        for leaf, places in enumerate(self.legs.places):
            task = self.study.task(leaf)
            if places and task.action is not Action.WAIT:
                onward = max(self._leg(place.standing, target) for place in places)
                longest = max(longest, self._leg(standing, task) + onward)
        return longest

    def _standing(self, target: Task) -> Standing:
        leg = self.travel.leg(self._start, target, None)
        return self._start if isinstance(leg, NoWay) else leg.arrival

    def _leg(self, standing: Standing, task: Task) -> float:
        leg = self.travel.leg(standing, task, None)
        return math.inf if isinstance(leg, NoWay) else leg.duration


def _may_pause(reaction: Reaction) -> bool:
    """Whether a reaction may leave the mission paused until a person resumes it."""
    if reaction.response.drives and reaction.afterwards is not Afterwards.END:
        return True  # if the drive fails, or as it says
    pauses = reaction.hold_limit is not None and reaction.on_limit is Afterwards.WAIT
    return reaction.holds and pauses
