"""Construction of the witnesses of an analysis from its intermediate results."""

from collections.abc import Iterable

from argo_compiler.analysis.non_terminating_loops import NonTerminatingLoop, make_trap
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.witness import Invariant, ReadingScale, Witnesses


def make_witnesses(study: Study, loops: Iterable[NonTerminatingLoop]) -> Witnesses:
    """Return the witnesses for the verdicts and the loops of a study, made in linear time."""
    return Witnesses(
        nominal=_invariant(study, study.nominal, failures=False),
        all=_invariant(study, study.with_failures, failures=True),
        traps=(
            *(make_trap(study, nodes) for nodes in study.trap_nodes),
            *(make_trap(study, sorted(loop.nodes), loop.readings_keeping_loop) for loop in loops),
        ),
    )


def _invariant(study: Study, reachability: Reachability, *, failures: bool) -> Invariant:
    flow, mission, fields = study.flow, study.mission, reachability.fields
    leaf_for = {leaf.name: i for i, leaf in enumerate(flow.leaves) if study.is_mission_task(i)}
    number_for = {group.name: g for g, group in enumerate(flow.groups)}
    tasks = [leaf_for.get(task.name) for task in mission.tasks]
    rounds = [flow.round_end_node(number_for[group.name]) for group in mission.groups]
    cuts = [flow.time_up_node(number_for[group.name]) for group in mission.groups]
    states, late = reachability.states, reachability.late
    return Invariant(
        failures=failures,
        scales=tuple(
            ReadingScale(o, fields.scales[o].bounds, shift)
            for o, shift in sorted(fields.shift.items(), key=lambda item: item[1])
        ),
        tasks=tuple(None if node is None else states[node] for node in tasks),
        rounds=tuple(states[node] for node in rounds),
        cuts=tuple(states[node] for node in cuts),
        ended=reachability.is_reached(flow.end_node),
        late_tasks=tuple(0 if node is None else late[node] for node in tasks),
        late_rounds=tuple(late[node] for node in rounds),
        late_cuts=tuple(late[node] for node in cuts),
    )
