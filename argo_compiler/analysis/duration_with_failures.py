"""Upper bound on the duration of a mission, whatever fails and whatever events occur.

Reactions are included. The assumptions are: Nobody interrupts the mission or takes the robot over.
An action that fails has failed by the time at which it would have ended. After one or several
actions in a row that failed or were cancelled, the robot is between two consecutive poses of the
planned paths.
"""

import math

from argo_compiler.analysis.bounds import longest_duration
from argo_compiler.analysis.path_lengths import BoundsTooLargeError
from argo_compiler.analysis.results import Bound
from argo_compiler.analysis.step_costs import StepCosts
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.travel import NoPath, RobotPose
from argo_compiler.il import Action, Afterwards, EventKind, Mode, Reaction, Response, Task

_MOST_LEAVES = 2_000
"""greatest number of leaves of a mission for which the bound is computed"""


def worst_case_duration_if_computable(study: Study) -> Bound | None:
    """Return an upper bound on the duration (s) of a mission, failures and reactions included.

    Its value is None if there is no limit. Returns None if it can't be computed: without travel
    times, if the mission is too large, or if the robot can't get to some task.
    """
    if study.travel is None or len(study.flow.leaves) > _MOST_LEAVES:
        return None
    costs = StepCosts(study.flow, study.with_failures, study.travel, study.mission)
    if costs.blocked or costs.too_many:
        return None
    try:
        within = longest_duration(study.flow, study.with_failures, costs)
    except BoundsTooLargeError:
        return None
    if study.bounds_if_computable is not None and study.bounds_if_computable.duration is not None:
        within = max(within, study.bounds_if_computable.duration.most.value or 0.0)
    reactions = _ReactionTimes(study, costs)
    return Bound(value=_finite(min(within + reactions.time_added(), reactions.end_by_time_up())))


def _finite(seconds: float) -> float | None:
    return seconds if math.isfinite(seconds) else None


class _ReactionTimes:
    """Durations of a mission's reactions.

    Nothing follows a reaction that ends the mission, so each of them is executed at most once.
    """

    def __init__(self, study: Study, costs: StepCosts) -> None:
        assert study.travel is not None
        self.study = study
        self.costs = costs
        self.travel = study.travel
        self.clean_up = study.travel.longest_cancellation_time
        self._start = study.travel.start_pose(study.mission)
        self.mission = study.mission
        self.reactions = [r for r in study.mission.reactions if r.response is not Response.REPORT]

    def time_added(self) -> float:
        """Return the greatest time in s that all reactions together can add to one run.

        It is infinite if a reaction does not always end the mission, as it may then interrupt it
        again and again, or if the mission starts supervised.
        """
        if self.mission.mode is Mode.SUPERVISORY:
            return math.inf
        return sum(map(self._time_to_end, self.reactions))

    def end_by_time_up(self) -> float:
        """Return the latest time in s at which the reaction to TIME_UP has ended the mission.

        It counts from the mission's start. It is infinite if there is no such reaction, or if the
        mission may continue.
        """
        limit = self.mission.max_duration
        last = next((r for r in self.reactions if r.event is EventKind.TIME_UP), None)
        if limit is None or last is None or self.mission.mode is Mode.SUPERVISORY:
            return math.inf
        if any(map(_may_pause, self.reactions)):
            return math.inf
        # A reaction of the same or a higher rank may be active when the time is up.
        return limit + sum(
            self._time_to_end(r) for r in self.reactions if r.urgency_score >= last.urgency_score
        )

    def _time_to_end(self, reaction: Reaction) -> float:
        """Return the greatest time in s from a reaction's event to the mission's end.

        It is infinite if the reaction does not always end the mission.
        """
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
        return self.clean_up + self._drive_time(reaction) + held

    def _drive_time(self, reaction: Reaction) -> float:
        """Return the greatest time in s of a reaction's drive to its pose, from anywhere.

        The robot may be on the mission's planned paths, or driving for another reaction.
        """
        target = self._drive_task(reaction)
        others = [self._drive_task(r) for r in self.reactions if r.response.drives]
        times = [self._longest_drive(target)]
        for other in others:
            if other != target:
                times.append(
                    self._longest_drive(other) + self._leg_time(self._pose_after(other), target)
                )
                times.append(self._longest_drive_past_leaves(other, target))
        return max(times)

    def _drive_task(self, reaction: Reaction) -> Task:
        pose = reaction.pose
        if reaction.response is Response.RETURN and pose is None:
            pose = self.mission.dock
        return Task(name="drive", action=Action.WAYPOINT, pose=pose)

    def _longest_drive(self, target: Task) -> float:
        """Return the greatest time in s of a drive to a task from anywhere on the planned paths.

        The planned paths are those to the tasks of the mission.
        """
        longest = self._leg_time(self._start, target)
        for leaf, positions in enumerate(self.costs.positions):
            if positions:
                cost = self.costs.task_cost_after_interrupted_leaf(leaf, target)
                longest = max(longest, math.inf if isinstance(cost, NoPath) else cost.time.most)
        return longest

    def _longest_drive_past_leaves(self, other: Task, target: Task) -> float:
        """Return the greatest time in s of a drive that interrupts the return from another one.

        Both are drives of reactions. The robot has been at the pose of `other`, may be anywhere
        between it and the next task of the mission, and now drives to `target`.
        """
        longest = 0.0
        pose = self._pose_after(other)
        for leaf, positions in enumerate(self.costs.positions):
            task = self.study.leaf_task(leaf)
            if positions and task.action is not Action.WAIT:
                onward = max(self._leg_time(position.pose, target) for position in positions)
                longest = max(longest, self._leg_time(pose, task) + onward)
        return longest

    def _pose_after(self, target: Task) -> RobotPose:
        leg = self.travel.leg_with_action(self._start, target, None)
        return self._start if isinstance(leg, NoPath) else leg.arrival

    def _leg_time(self, pose: RobotPose, task: Task) -> float:
        leg = self.travel.leg_with_action(pose, task, None)
        return math.inf if isinstance(leg, NoPath) else leg.duration


def _may_pause(reaction: Reaction) -> bool:
    """Return True if a reaction may leave the mission paused until a person resumes it."""
    if reaction.response.drives and reaction.afterwards is not Afterwards.END:
        return True  # if the drive fails, or because `afterwards` demands it
    pauses = reaction.hold_limit is not None and reaction.on_limit is Afterwards.WAIT
    return reaction.holds and pauses
