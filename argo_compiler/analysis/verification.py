"""Checker of witnesses, independent of the code that constructs them.

It reads a mission by the rules of `docs/language.md` alone and uses nothing of the analysis but the
format of its witnesses. It visits each step of the mission once.
"""

from argo_compiler.analysis.verification_layout import END, MissionLayout, ProgramPoint
from argo_compiler.analysis.verification_states import ClaimedStates
from argo_compiler.analysis.verification_walk import MissionWalk, Proved
from argo_compiler.analysis.witness import Invariant, Trap
from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission


class Verifier:
    """Checker of witnesses for one mission."""

    def __init__(self, mission: Mission, catalog: Catalog | None) -> None:
        self._mission = mission
        self._layout = MissionLayout(mission)
        checkpoints = () if catalog is None else catalog.checkpoints
        self._ranges = {
            str(c.id): (c.range.low, c.range.high, c.nominal.low, c.nominal.high)
            for c in checkpoints
        }

    def check_invariant(self, witness: Invariant) -> Proved | None:
        """Return what an invariant proves about the mission.

        Returns None if some step leads out of the invariant, or if its format is wrong.
        """
        states = self._states(witness)
        if states is None:
            return None
        proved = Proved(ended=witness.ended)
        proved.tasks = {at for kind, at in states.readings if kind == "task"}
        walk = MissionWalk(
            self._mission, self._layout, states, witness.failures, proved, self._ranges
        )
        if not states.contains(*walk.step_to_mission_start()):
            return None
        for here in list(states.readings):
            if not all(states.contains(*step) for step in walk.steps(here)):
                return None
        return proved

    def check_trap(self, witness: Trap, invariant: Invariant) -> bool:
        """Return True if no step leads out of a trap while the readings are those of an invariant.

        The invariant must be without failures and have passed `check_invariant`.
        """
        states = self._states(invariant)
        points = self._points_of(witness)
        if states is None or points is None or not points or invariant.failures:
            return False
        if witness.kept is not None:
            restricted = states.restricted_to(witness.kept, self._ranges)
            if restricted is None:
                return False
            states = restricted
        walk = MissionWalk(self._mission, self._layout, states, False, Proved(), self._ranges)
        for here in points:
            if here not in states.readings:
                continue
            for point, state, _ in walk.steps(here):
                if point not in points or not states.continues_with_kept_readings(
                    point, state, witness.kept
                ):
                    return False
        return any(here in states.readings for here in points)

    def _points_of(self, witness: Trap) -> set[ProgramPoint] | None:
        task, group = self._layout.position, self._layout.group_position
        if not (set(witness.tasks) <= task.keys() and witness.tasks):
            return None
        if not {*witness.rounds, *witness.cuts} <= group.keys():
            return None
        return {
            *(("task", task[name]) for name in witness.tasks),
            *(("round", group[name]) for name in witness.rounds),
            *(("cut", group[name]) for name in witness.cuts),
        }

    def _states(self, witness: Invariant) -> ClaimedStates | None:
        columns = (
            ("task", witness.tasks, witness.late_tasks, len(self._mission.tasks)),
            ("round", witness.rounds, witness.late_rounds, len(self._mission.groups)),
            ("cut", witness.cuts, witness.late_cuts, len(self._mission.groups)),
        )
        states = ClaimedStates({}, {}, {}, 0)
        for scale in witness.scales:
            if not states.add_scale(scale.object_id, scale.bounds, scale.shift, self._ranges):
                return None
        for kind, known, late, size in columns:
            if len(known) != size or len(late) != size:
                return None
            for at, state in enumerate(known):
                if state is not None:
                    states.readings[kind, at] = state
                if late[at]:
                    states.late[kind, at] = late[at]
        if witness.ended:
            states.readings[END] = states.late[END] = -1
        return states
