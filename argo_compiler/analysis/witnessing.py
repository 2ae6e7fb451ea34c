"""The witnesses of what an analysis claims, from what it has found on its way."""

from collections.abc import Iterable

from argo_compiler.analysis.kept import KeptLoop, trap_of
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.values import Paths
from argo_compiler.analysis.witness import Invariant, ReadingScale, Witnesses


def make_witnesses(study: Study, kept: Iterable[KeptLoop]) -> Witnesses:
    """What shows that the claims of a study are right, in linear time."""
    return Witnesses(
        nominal=_invariant(study, study.nominal, failures=False),
        all=_invariant(study, study.with_failures, failures=True),
        traps=(
            *(trap_of(study, nodes) for nodes in study.trap_nodes),
            *(trap_of(study, sorted(loop.nodes), loop.reading) for loop in kept),
        ),
    )


def _invariant(study: Study, paths: Paths, *, failures: bool) -> Invariant:
    flow, mission, fields = study.flow, study.mission, paths.fields
    leaf_of = {leaf.name: i for i, leaf in enumerate(flow.leaves) if study.is_own(i)}
    number_of = {group.name: g for g, group in enumerate(flow.groups)}
    tasks = [leaf_of.get(task.name) for task in mission.tasks]
    rounds = [flow.round_end(number_of[group.name]) for group in mission.groups]
    cuts = [flow.time_up(number_of[group.name]) for group in mission.groups]
    states, late = paths.states, paths.late
    return Invariant(
        failures=failures,
        scales=tuple(
            ReadingScale(o, fields.scales[o].bounds, shift)
            for o, shift in sorted(fields.shift.items(), key=lambda item: item[1])
        ),
        tasks=tuple(None if node is None else states[node] for node in tasks),
        rounds=tuple(states[node] for node in rounds),
        cuts=tuple(states[node] for node in cuts),
        ended=paths.reached(flow.done),
        late_tasks=tuple(0 if node is None else late[node] for node in tasks),
        late_rounds=tuple(late[node] for node in rounds),
        late_cuts=tuple(late[node] for node in cuts),
    )
