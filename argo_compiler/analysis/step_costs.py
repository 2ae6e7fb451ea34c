"""Costs of the steps of a control-flow graph: ranges of time and energy over all robot poses."""

import math
from collections import deque
from collections.abc import Iterable, Iterator

from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.travel import Leg, NoPath, RobotPose, Travel
from argo_compiler.base.graphs import components
from argo_compiler.base.records import dataclass
from argo_compiler.il import Mission, Task

BEGIN = "begin"
"""source of the first step"""
ANY = "any"
"""source that stands for all sources"""
_MOST_POSES = 4  # distinguished after one leaf; the pose to read from depends on the path there
_MOST_WAIT_POSITIONS = 64  # positions distinguished at one WAIT


@dataclass(frozen=True, slots=True)
class QuantityRange:
    """Range of a quantity; `most` may be infinite."""

    least: float
    most: float

    def __add__(self, other: "QuantityRange") -> "QuantityRange":
        return QuantityRange(self.least + other.least, self.most + other.most)

    def __or__(self, other: "QuantityRange") -> "QuantityRange":
        return QuantityRange(min(self.least, other.least), max(self.most, other.most))

    def times(self, count: float) -> "QuantityRange":
        """Return the range multiplied by a count; NOTHING if the count is not positive."""
        if count <= 0:
            return NOTHING
        return QuantityRange(
            self.least * count if self.least else 0.0, self.most * count if self.most else 0.0
        )


NOTHING = QuantityRange(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Cost:
    """Cost in time and energy."""

    time: QuantityRange
    """s"""
    energy: QuantityRange
    """Wh"""

    def __add__(self, other: "Cost") -> "Cost":
        if self is FREE:
            return other
        return Cost(self.time + other.time, self.energy + other.energy)

    def __or__(self, other: "Cost") -> "Cost":
        return Cost(self.time | other.time, self.energy | other.energy)

    def times(self, count: float) -> "Cost":
        return Cost(self.time.times(count), self.energy.times(count))


FREE = Cost(NOTHING, NOTHING)
_UNLIMITED = Cost(QuantityRange(0.0, math.inf), QuantityRange(0.0, math.inf))

Source = int | tuple[str, int] | str
"""Start of a step: a leaf that has ended, BEGIN, ANY, ("cut", g) after the time of group g was up,
("missed", i) after the window of leaf i had closed, or ("repeat", g) after a round of group g,
whichever leaf ended last."""


@dataclass(frozen=True, slots=True)
class RobotPosition:
    """Position of the robot: at a pose, or somewhere on its way to a leaf's pose."""

    pose: RobotPose
    on_way_to: int | None = None
    """leaf whose action was cancelled on the way; None if the robot stands at the pose"""


class StepCosts:
    """Costs of all steps of a mission, computed once from the travel.

    Without travel, all steps cost between nothing and any amount. If the reachability includes
    failures, any action may fail, at the latest when it would have ended, and is retried as its
    task says. Then only the upper bounds of the costs are valid, and a failed action may have left
    the robot anywhere between two consecutive poses of the planned paths.
    """

    def __init__(
        self, flow: Flow, reachability: Reachability, travel: Travel | None, mission: Mission
    ) -> None:
        self.flow = flow
        self.reachability = reachability
        self.travel = travel
        self.blocked: dict[int, str] = {}
        """leaves that the robot can't get to from some pose, and why"""
        self.positions: list[list[RobotPosition]] = [[] for _ in flow.leaves]
        """for each leaf, the possible positions of the robot when it has ended"""
        self.too_slow: dict[int, float] = {}
        """leaves that always exceed their time limit, and the least time (s) that they take"""
        self.too_slow_anywhere: set[int] = set()
        """those of them whose work alone exceeds the limit, wherever the robot comes from"""
        self.sometimes_too_slow: set[int] = set()
        """leaves that exceed their time limit from some pose"""
        self.too_many = False
        """whether there are more positions at a WAIT than are distinguished"""
        self.standing_power = 0.0 if travel is None else travel.standing_power
        self._steps: dict[tuple[Source, int], Cost] = {}
        self._positions_before: list[list[RobotPosition]] = [[] for _ in flow.leaves]
        """for each leaf, the positions of the robot before it, if they matter for what follows"""
        self._origins: list[dict[RobotPose, None]] = [{} for _ in flow.leaves]
        """for each leaf, the poses from which the robot drives to it"""
        self._cuts: dict[Source, dict[tuple[int, int], None]] = {}
        """for each source, the leaf that the robot was driving to and the leaf that follows"""
        self._action_costs: dict[int, Cost] = {}
        self._round_starts = frozenset(g.start for g in flow.groups if g.every)
        self._pending: deque[tuple[int, RobotPosition, bool]] = deque()
        if travel is not None:
            self._explore(travel, mission)
            self._add_cut_costs(travel)
            self._join_repeats()
            self._find_too_slow()
            if reachability.failures:
                self._include_retries(travel.longest_cancellation_time)
            for (_, target), cost in list(self._steps.items()):
                self._join(ANY, target, cost)

    def step_cost(self, source: Source, target: int) -> Cost:
        """Return the cost of a step: the drive from a source to a leaf, and the leaf's action.

        It includes the time that the robot may have to wait there until the leaf's `earliest` time.
        """
        cost = self.cost_without_wait(source, target)
        if self.travel is None or not self.flow.is_leaf(target):
            return cost
        earliest = self.flow.leaves[target].earliest
        if not earliest:
            return cost
        most = max(cost.time.most, earliest + self.action_cost(target).time.most)
        waiting = QuantityRange(0.0, self.standing_power * earliest / 3600)
        return Cost(QuantityRange(cost.time.least, most), cost.energy + waiting)

    def cost_without_wait(self, source: Source, target: int) -> Cost:
        """Return the cost of a step, without any wait for the leaf's `earliest` time."""
        if not self.flow.is_leaf(target):
            return FREE
        if self.travel is None:
            return _UNLIMITED
        return self._steps.get((source, target), FREE)

    def cost_until_window_closes(self, source: Source, target: int) -> Cost:
        """Return the cost of a step to a leaf that is cancelled as the leaf's hard window closes.

        It may have closed before the step begins, so the least is 0.
        """
        cost = self.step_cost(source, target)
        deadline = self.flow.leaves[target].deadline
        assert deadline is not None
        return Cost(
            QuantityRange(0.0, min(cost.time.most, deadline)), QuantityRange(0.0, cost.energy.most)
        )

    def action_cost(self, leaf: int) -> Cost:
        """Return the range of the cost of a leaf's action, without the drive to it."""
        return self._action_costs.get(leaf, FREE)

    def least_times_to_successors(self) -> dict[object, list[tuple[object, float]]]:
        """Return what can follow each leaf or time-out, with the least s between their ends."""
        following: dict[object, list[tuple[object, float]]] = {}
        for (source, target), cost in self._steps.items():
            if isinstance(source, str) or (not isinstance(source, int) and source[0] == "repeat"):
                continue
            after = following.setdefault(source, [])
            after.append((target, cost.time.least))
            # The action may be cancelled as soon as it is started.
            after += [(cut, 0.0) for cut, _ in self._successors_when_cut(target)]
        return following

    def cancelled_action_clean_up_time(self, source: Source) -> float:
        """Return the longest time in s to clean up a cancelled action if the mission then ends.

        The mission ends after `source`. The time is 0 if no action can have been cancelled before.
        """
        if self.travel is None or isinstance(source, str):
            return 0.0
        if isinstance(source, int):
            cancelled = any(position.on_way_to is not None for position in self.positions[source])
        else:
            cancelled = source[0] in ("cut", "missed")
        return self.travel.longest_cancellation_time if cancelled else 0.0

    def _successors(self, leaf: int) -> Iterator[tuple[Source, int]]:
        """Yield the source and leaf of each step that can follow an ended or cancelled leaf."""
        for target in self.reachability.targets(self.flow, leaf):
            yield from ((leaf, t) for t in self._resolve(target))
        yield from self._successors_when_cut(leaf)

    def _successors_when_cut(self, leaf: int) -> Iterator[tuple[Source, int]]:
        """Yield the source and leaf of each step that can follow if time cancels a leaf.

        That is when the time of a group is up or the hard window of the leaf has closed.
        """
        flow = self.flow
        group = flow.leaves[leaf].parent
        while group >= 0 and flow.timed[group]:
            if flow.groups[group].hard:
                for t in self._resolve(flow.groups[group].successor):
                    yield ("cut", group), t
            group = flow.groups[group].parent
        for target in self.reachability.targets_when_missed(flow, leaf):
            for t in self._resolve(target):
                yield ("missed", leaf), t

    def _resolve(self, node: int) -> tuple[int, ...]:
        """Return the leaves that can follow a node directly; for a leaf, the leaf itself."""
        flow = self.flow
        leaves = []
        group = flow.group_of_round_end(node)
        while group is not None:
            if flow.groups[group].may_repeat:
                leaves.append(flow.groups[group].start)
            if not flow.groups[group].has_limit_or_until:
                return tuple(leaves)
            node = flow.groups[group].successor
            group = flow.group_of_round_end(node)
        if flow.is_leaf(node):
            leaves.append(node)
        return tuple(leaves)

    def _explore(self, travel: Travel, mission: Mission) -> None:
        """Add the positions of the robot after each leaf, and the costs of the steps to leaves."""
        flow = self.flow
        if not flow.is_leaf(flow.initial):
            return
        self._add_step(travel, BEGIN, RobotPosition(travel.start_pose(mission)), flow.initial)
        ended: list[list[tuple[Source, int]] | None] = [None] * len(flow.leaves)
        while self._pending:
            leaf, position, before = self._pending.popleft()
            successors = ended[leaf]
            if successors is None:
                successors = ended[leaf] = list(dict.fromkeys(self._successors(leaf)))
            for source, target in successors:
                if source != leaf:
                    at = position if before else RobotPosition(position.pose, leaf)
                    self._add_step(travel, source, at, target)
                elif not before or flow.leaves[leaf].wait is not None:
                    self._add_step(travel, source, position, target)
                    if self.reachability.failures and not before:
                        self._add_step(travel, source, RobotPosition(position.pose, leaf), target)

    def _add_step(
        self, travel: Travel, source: Source, position: RobotPosition, target: int
    ) -> None:
        leaf = self.flow.leaves[target]
        if leaf.wait is not None:
            self._join(source, target, self._wait_cost(target))
            self._action_costs[target] = FREE
            if self._record_position(self._positions_before[target], position, target, before=True):
                self.positions[target].append(position)
            return
        task = leaf.leaf.task
        leg = travel.leg_with_action(position.pose, task, task.velocity)
        if isinstance(leg, NoPath):
            self.blocked.setdefault(target, leg.reason)
            leg = Leg(0.0, 0.0, position.pose)
        if position.on_way_to is None:
            self._join(source, target, _cost(leg))
            self._origins[target].setdefault(position.pose)
        else:
            self._cuts.setdefault(source, {})[position.on_way_to, target] = None
        work = Cost(
            QuantityRange(leg.work, leg.work), QuantityRange(leg.work_energy, leg.work_energy)
        )
        known = self._action_costs.get(target)
        self._action_costs[target] = work if known is None else known | work
        if (
            position.on_way_to is not None
            or leaf.deadline is not None
            or target in self._round_starts
        ):
            # The action may be cancelled before it is started.
            self._record_position(self._positions_before[target], position, target, before=True)
        self._record_position(
            self.positions[target], RobotPosition(leg.arrival), target, before=False
        )

    def _record_position(
        self, known: list[RobotPosition], position: RobotPosition, leaf: int, *, before: bool
    ) -> bool:
        """Add a position to `known` and to the pending ones; return True if it was added.

        It is not added if it is known, or if there are too many. `before` states if the robot is
        there when the leaf begins, not when it has ended.
        """
        if position in known:
            return False
        if len(known) >= (_MOST_WAIT_POSITIONS if before else _MOST_POSES):
            self.too_many = self.too_many or before
            return False
        known.append(position)
        self._pending.append((leaf, position, before))
        return True

    def _wait_cost(self, leaf: int) -> Cost:
        """Return the cost of a WAIT, without regard to its window."""
        rule = self.flow.leaves[leaf].wait
        assert rule is not None
        if rule.duration is not None:
            time = QuantityRange(rule.duration, rule.duration)
        else:
            time = QuantityRange(0.0, math.inf if rule.limit is None else rule.limit)
        # At a dock, waiting takes nothing from the battery.
        energy = self.standing_power * time.most / 3600 if self.standing_power else 0.0
        return Cost(time, QuantityRange(0.0, energy))

    def _join(self, source: Source, target: int, cost: Cost) -> None:
        known = self._steps.get((source, target))
        self._steps[source, target] = cost if known is None else known | cost

    def _join_repeats(self) -> None:
        """Add the steps from the end of a group's round to the first leaf of its next round.

        The source of such a step is `("repeat", group)`. Its cost is the range of the costs of all
        steps that begin another round of the group, whichever leaf ended last.
        """
        flow = self.flow
        ends: list[tuple[Source, int]] = [
            (i, leaf.unconditional)
            for i, leaf in enumerate(flow.leaves)
            if self.reachability.is_reached(i) and self.reachability.unconditional_possible(flow, i)
        ]
        ends += [
            (("missed", i), leaf.unconditional)
            for i, leaf in enumerate(flow.leaves)
            if leaf.deadline is not None
        ]
        ends += [(("cut", i), group.successor) for i, group in enumerate(flow.groups) if group.hard]
        for source, node in ends:
            group = flow.group_of_round_end(node)
            while group is not None:
                start = flow.groups[group].start
                if (source, start) in self._steps:
                    self._join(("repeat", group), start, self._steps[source, start])
                group = flow.group_of_round_end(flow.groups[group].successor)

    def _find_too_slow(self) -> None:
        fastest: dict[int, float] = {}
        for (_, target), cost in self._steps.items():
            fastest[target] = min(fastest.get(target, math.inf), cost.time.least)
            limit = self.flow.leaves[target].leaf.task.time_limit
            if limit is not None and cost.time.most > limit:
                self.sometimes_too_slow.add(target)
        for target, taken in fastest.items():
            leaf = self.flow.leaves[target]
            limit = leaf.leaf.task.time_limit
            # The time before `earliest` does not count: the robot may have arrived before it.
            counted = self.action_cost(target).time.least if leaf.earliest else taken
            if limit is not None and counted > limit:
                self.too_slow[target] = counted
                if self.action_cost(target).time.least > limit:
                    self.too_slow_anywhere.add(target)

    def _include_retries(self, clean_up: float) -> None:
        """Replace the costs of steps by ranges from 0 to the most that all attempts cost.

        They include the clean-up after each attempt. No attempt takes longer than the first one.
        """
        longest: dict[int, Cost] = {}
        for (source, target), cost in self._steps.items():
            leaf = self.flow.leaves[target]
            if leaf.wait is not None:
                continue
            task = leaf.leaf.task
            attempt = cost.time.most
            if task.time_limit is not None:
                attempt = min(attempt, task.time_limit + clean_up)
            tries = task.retries + 1
            spent = Cost(
                QuantityRange(0.0, (attempt + clean_up) * tries),
                QuantityRange(0.0, cost.energy.most * tries),
            )
            self._steps[source, target] = spent
            longest[target] = longest.get(target, FREE) | spent
        self._action_costs |= longest

    def task_cost_after_leaf(self, leaf: int, target: Task) -> Cost | NoPath:
        """Return the cost of the drive to a task and of its action, from the end of a leaf.

        The task need not be one of the mission: it may be the drive back to the dock. The most is
        that of the worst possible position of the robot when the leaf has ended; the least is 0.
        Returns NoPath if the robot can't execute the task from one of these positions.
        """
        assert self.travel is not None
        cost = FREE
        for position in self.positions[leaf]:
            leg = self.travel.leg_with_action(position.pose, target, target.velocity)
            if isinstance(leg, NoPath):
                return leg
            cost = cost | _cost(leg)
        return cost

    def task_cost_after_interrupted_leaf(self, leaf: int, target: Task) -> Cost | NoPath:
        """Return the cost of the drive to a task and of its action, from a leaf or the drive to it.

        The robot may be anywhere on its drive to the leaf, or the leaf may have ended. The task
        need not be one of the mission: it may be the drive of a reaction. Returns NoPath if the
        robot can't execute the task from one of its positions when the leaf has ended.
        """
        assert self.travel is not None
        direct = self.task_cost_after_leaf(leaf, target)
        if isinstance(direct, NoPath) or self.flow.leaves[leaf].wait is not None:
            return direct
        cut_costs = _CutCosts(self.flow, self.travel, self._origins, self.positions)
        return direct + cut_costs.remainder(leaf, target.velocity)

    def _add_cut_costs(self, travel: Travel) -> None:
        """Add the costs of the steps from any position at which an action was cancelled.

        The robot was on its way to a leaf x, or executing its action. Upper bound: after cleaning
        up, it could continue to x and then drive to the target, at the target's speed. Lower bound:
        the robot may almost be at the target, so only the target's action counts.
        """
        cut_costs = _CutCosts(self.flow, travel, self._origins, self.positions)
        if not self.reachability.failures:
            cut_costs.allow_chains(self._cuts)
        for source, pairs in self._cuts.items():
            for x, target in pairs:
                most = cut_costs.longest_to(x, target)
                work = self.action_cost(target)
                rest = Cost(
                    QuantityRange(min(work.time.least, most.time.most), most.time.most),
                    QuantityRange(min(work.energy.least, most.energy.most), most.energy.most),
                )
                waited = Cost(QuantityRange(0.0, travel.longest_cancellation_time), NOTHING)
                self._join(source, target, rest + waited)


class _CutCosts:
    """Longest drives from the positions at which an action was cancelled; caches its results."""

    def __init__(
        self,
        flow: Flow,
        travel: Travel,
        origins: list[dict[RobotPose, None]],
        positions: list[list[RobotPosition]],
    ) -> None:
        self.flow = flow
        self.travel = travel
        self.origins = origins
        self.positions = positions
        self.detours: list[list[int]] = []
        """for each leaf, the leaves that the robot may have been driving to when it was started"""
        self._remainders: dict[tuple[int, float | None], Cost] = {}
        self._order: dict[int, int] = {}
        """for each leaf, its rank in an order in which it follows its detours"""
        self._endless: set[int] = set()
        """leaves with detours that lead back to them"""

    def allow_chains(self, cuts: dict[Source, dict[tuple[int, int], None]]) -> None:
        """Include from now on that several actions in a row are cancelled.

        `cuts` has, for each source, pairs of the leaf that the robot was driving to and the next
        one.
        """
        self.detours = [[] for _ in self.flow.leaves]
        for pairs in cuts.values():
            for x, target in pairs:
                if x != target and x not in self.detours[target]:
                    self.detours[target].append(x)
        for number, part in enumerate(components(self.detours)):
            self._order |= dict.fromkeys(part, number)
            self._endless.update(part if len(part) > 1 else ())

    def longest_to(self, x: int, target: int) -> Cost:
        """Return the cost of the drive to `target` and its action, from the worst position.

        The positions are those on the drive to leaf `x`, which the robot first completes.
        """
        velocity = self.flow.leaves[target].leaf.task.velocity
        cost = self.remainder(x, velocity)
        return cost if x == target else cost + self._cost_between(x, target, velocity)

    def remainder(self, x: int, velocity: float | None) -> Cost:
        """Return the cost of the rest of the drive to leaf `x` and of its action, at a speed.

        It is that of the worst position at which the action was cancelled. The speed is in m/s;
        None is the robot's planning speed.
        """
        if (x, velocity) not in self._remainders:
            if self.detours:
                self._compute_remainder(x, velocity)
            else:
                self._remainders[x, velocity] = self._longest_leg(self.origins[x], x, velocity)
        return self._remainders[x, velocity]

    def _compute_remainder(self, leaf: int, velocity: float | None) -> None:
        """Compute the greatest cost of the drive to a leaf and of its action, at a speed.

        It covers all positions before the leaf; the speed is in m/s. The same is computed for the
        leaves that the robot may have been driving to before.
        """
        needed: set[int] = set()
        pending = [leaf]
        while pending:
            x = pending.pop()
            if x not in needed and (x, velocity) not in self._remainders:
                needed.add(x)
                pending += () if x in self._endless else self.detours[x]
        for x in sorted(needed, key=self._order.__getitem__):
            if x in self._endless:
                self._remainders[x, velocity] = _UNLIMITED
                continue
            cost = self._longest_leg(self.origins[x], x, velocity)
            for y in self.detours[x]:
                cost = cost | (self._remainders[y, velocity] + self._cost_between(y, x, velocity))
            self._remainders[x, velocity] = cost

    def _cost_between(self, x: int, target: int, velocity: float | None) -> Cost:
        poses = [position.pose for position in self.positions[x]]
        return self._longest_leg(poses, target, velocity)

    def _longest_leg(self, poses: Iterable[RobotPose], target: int, velocity: float | None) -> Cost:
        task = self.flow.leaves[target].leaf.task
        cost = FREE
        for pose in poses:
            leg = self.travel.leg_with_action(pose, task, velocity)
            if not isinstance(leg, NoPath):
                cost = cost | _cost(leg)
        return cost


def _cost(leg: Leg) -> Cost:
    return Cost(QuantityRange(leg.duration, leg.duration), QuantityRange(leg.energy, leg.energy))
