"""Entry point of the analysis: results for all execution paths of a mission."""

from collections.abc import Sequence
from dataclasses import replace

from argo_compiler.analysis.bound_verification import (
    AT_LEAST,
    bounds_unproved_by_steps,
    least_steps_if_computable,
)
from argo_compiler.analysis.bound_witness_search import find_least_witness
from argo_compiler.analysis.charging import diagnose_charge_and_place
from argo_compiler.analysis.duration_with_failures import worst_case_duration_if_computable
from argo_compiler.analysis.endings import diagnose_endings
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.limits import (
    diagnose_limits_and_missing_paths,
    stale_value_diagnostics_if_computable,
)
from argo_compiler.analysis.non_terminating_loops import find_loops_kept_by_readings
from argo_compiler.analysis.reachability import compute_reachability, make_fields
from argo_compiler.analysis.results import (
    Analysis,
    GroupFacts,
    TaskFacts,
    TransitionFacts,
    Verdict,
)
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.transitions import diagnose_transitions
from argo_compiler.analysis.travel import Travel
from argo_compiler.analysis.unreachable_tasks import diagnose_unreachable_tasks
from argo_compiler.analysis.verification_claims import unproved
from argo_compiler.analysis.witness_construction import make_witnesses
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm.lowering import lower
from argo_compiler.il import Mission

_WITNESSED = frozenset(
    f"analysis.{code}"
    for code in (
        "endless-loop",
        "kept-loop",
        "never-measured",
        "no-end",
        "transition-always",
        "transition-never",
        "unreachable-task",
    )
)
"""codes of the diagnostics on what never or always happens, which a witness must prove"""

_SUBJECTS = {
    "analysis.too-long": Message("whether the mission takes too long on all paths"),
    "analysis.battery-exceeded": Message("whether the battery never suffices"),
    "analysis.window-late": Message("whether some windows are always missed"),
    "analysis.window-missed": Message("whether some windows are always missed"),
}
"""for each code of a claim on a lower bound, what `unjudged` says if no witness proves the claim"""


def analyse(
    mission: Mission, catalog: Catalog | None = None, travel: Travel | None = None
) -> Analysis:
    """Return what can and can't happen on a mission, whatever values are measured.

    `docs/analysis.md` lists the assumptions.

    Args:
        mission: The mission to analyse.
        catalog: Limits the values that checkpoints can show and gives the docks; without it, a
            checkpoint may show any value.
        travel: Gives travel times and energy; without it, durations and energy are left out.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: The robot can't stand where the mission starts.
    """
    with collector_held():
        return _analyse(mission, catalog, travel)


def _analyse(mission: Mission, catalog: Catalog | None, travel: Travel | None) -> Analysis:
    flow = Flow.from_machine(lower(mission), mission)
    fields = make_fields(flow, catalog)
    study = Study(
        mission,
        catalog,
        travel,
        flow,
        nominal=compute_reachability(flow, fields, actions_may_fail=False),
        with_failures=compute_reachability(flow, fields, actions_may_fail=True),
    )
    unjudged = []
    if len(fields.shift) < len(fields.scales):
        names = tuple(sorted(fields.scales.keys() - fields.shift.keys())[:10])
        unjudged.append(
            Message("the values of some checkpoints along the paths ({names})", names=names)
        )
    loops = tuple(find_loops_kept_by_readings(study))
    diagnostics = [
        *diagnose_unreachable_tasks(study),
        *diagnose_transitions(study),
        *diagnose_endings(study, loops),
        *diagnose_charge_and_place(study),
    ]
    longest = (
        None if study.bounds_if_computable is None else worst_case_duration_if_computable(study)
    )
    if study.bounds_if_computable is None:
        unjudged.append(Message("loops and durations"))
    elif travel is not None:
        diagnostics += diagnose_limits_and_missing_paths(study, travel, longest)
        stale = stale_value_diagnostics_if_computable(study)
        if stale is None:
            unjudged.append(Message("ages of values"))
        else:
            diagnostics += stale
    bounds = study.bounds_if_computable
    analysis = Analysis(
        diagnostics=tuple(diagnostics),
        tasks=tuple(
            _task_facts(study, i) for i in range(len(flow.leaves)) if study.is_mission_task(i)
        ),
        groups=tuple(_group_facts(study, g) for g in range(len(flow.groups))),
        ends=_reach_verdict(study, flow.end_node),
        duration=None if bounds is None else bounds.duration,
        energy=None if bounds is None else bounds.energy,
        duration_with_failures=longest,
        unjudged=tuple(unjudged),
        witnesses=make_witnesses(study, loops),
    )
    wrong = unproved(mission, catalog, analysis)
    if wrong:
        analysis = with_all_verdicts_possible(analysis, wrong)
    return analysis if travel is None else _with_proved_bounds(mission, catalog, travel, analysis)


def _with_proved_bounds(
    mission: Mission, catalog: Catalog | None, travel: Travel, analysis: Analysis
) -> Analysis:
    """Return the analysis with a witness of its lower bounds, and without those it does not prove.

    Left out are the diagnostics that claim a lower bound on time or energy which the witness does
    not prove (see `without_unproved_diagnostics`).
    """
    if not any(d.code in AT_LEAST for d in analysis.diagnostics):
        return analysis
    witnesses, steps = analysis.witnesses, None
    if witnesses is not None:
        steps = least_steps_if_computable(mission, catalog, travel, witnesses.nominal)
        least = None if steps is None else find_least_witness(steps)
        witnesses = replace(witnesses, least=least)
        analysis = analysis.model_copy(update={"witnesses": witnesses})
    return without_unproved_diagnostics(analysis, bounds_unproved_by_steps(steps, analysis))


def without_unproved_diagnostics(
    analysis: Analysis, unproved_claims: Sequence[Diagnostic]
) -> Analysis:
    """Return the analysis without the `unproved_claims`, whose lower bounds no witness proves.

    `unjudged` of the result names what is therefore not known.
    """
    if not unproved_claims:
        return analysis
    subjects = ", ".join(dict.fromkeys(_SUBJECTS[d.code] for d in unproved_claims))
    return analysis.model_copy(
        update={
            "diagnostics": tuple(d for d in analysis.diagnostics if d not in unproved_claims),
            "unjudged": (*analysis.unjudged, subjects),
        }
    )


def with_all_verdicts_possible(analysis: Analysis, rejected_claims: Sequence[str]) -> Analysis:
    """Return the analysis without all results that rest on its witnesses, as some are wrong.

    Every verdict becomes POSSIBLE, and `unjudged` gets the texts in `rejected_claims`, which name
    the results that a witness should prove and does not.
    """
    tasks = tuple(
        TaskFacts(
            task=facts.task,
            verdict=Verdict.POSSIBLE,
            transitions=tuple(
                transition.model_copy(update={"verdict": Verdict.POSSIBLE})
                for transition in facts.transitions
            ),
        )
        for facts in analysis.tasks
    )
    groups = tuple(
        GroupFacts(group=facts.group, repeats=Verdict.POSSIBLE, ends=Verdict.POSSIBLE)
        for facts in analysis.groups
    )
    return analysis.model_copy(
        update={
            "diagnostics": tuple(d for d in analysis.diagnostics if d.code not in _WITNESSED),
            "tasks": tasks,
            "groups": groups,
            "ends": Verdict.POSSIBLE,
            "unjudged": (*analysis.unjudged, *rejected_claims),
            "witnesses": None,
        }
    )


def _reach_verdict(study: Study, node: int) -> Verdict:
    if study.nominal.is_reached(node):
        return Verdict.POSSIBLE
    return Verdict.AFTER_FAILURE if study.with_failures.is_reached(node) else Verdict.NEVER


def _task_facts(study: Study, leaf: int) -> TaskFacts:
    task = study.leaf_task(leaf)
    conditional = 0
    facts = []
    for index, transition in enumerate(task.transitions):
        if transition.conditions:
            verdict = _conditional_verdict(study, leaf, conditional)
            conditional += 1
        else:
            verdict = _unconditional_verdict(study, leaf)
        facts.append(TransitionFacts(index=index, target=transition.target, verdict=verdict))
    return TaskFacts(task=task.name, verdict=_reach_verdict(study, leaf), transitions=tuple(facts))


def _conditional_verdict(study: Study, leaf: int, k: int) -> Verdict:
    nominal = study.nominal.conditional_guards(study.flow, leaf)
    if k < len(nominal) and nominal[k].certain:
        return Verdict.ALWAYS
    if k < len(nominal) and nominal[k].possible:
        return Verdict.POSSIBLE
    guards = study.with_failures.conditional_guards(study.flow, leaf)
    return Verdict.AFTER_FAILURE if k < len(guards) and guards[k].possible else Verdict.NEVER


def _unconditional_verdict(study: Study, leaf: int) -> Verdict:
    """Return the verdict on whether a task's unconditional transition can be taken.

    If groups end with the task, the transition is taken only after their last rounds.
    """
    flow = study.flow
    for reachability, verdict in (
        (study.nominal, Verdict.POSSIBLE),
        (study.with_failures, Verdict.AFTER_FAILURE),
    ):
        if reachability.is_reached(leaf) and reachability.unconditional_possible(flow, leaf):
            node = flow.leaves[leaf].unconditional
        elif any(
            reachability.is_reached(flow.time_up_node(g))
            for g in _hard_groups_ending_with(study, leaf)
        ):
            return verdict
        else:
            continue
        group = flow.group_of_round_end(node)
        if group is None:
            conditional = reachability.conditional_guards(flow, leaf)
            alone = verdict is Verdict.POSSIBLE and not any(guard.possible for guard in conditional)
            return Verdict.ALWAYS if alone else verdict
        if any(
            reachability.is_reached(flow.time_up_node(g))
            for g in _hard_groups_ending_with(study, leaf)
        ):
            return verdict
        while group is not None and flow.groups[group].has_limit_or_until:
            group = flow.group_of_round_end(flow.groups[group].successor)
        if group is None:
            return verdict
    return Verdict.NEVER


def _hard_groups_ending_with(study: Study, leaf: int) -> list[int]:
    """Return the numbers of the groups with a hard time limit whose last leaf is `leaf`.

    Those within an endless group with the same last leaf are left out: when their time is up, the
    next round of the endless group follows, not the unconditional transition of the leaf.
    """
    flow = study.flow
    groups = []
    group = flow.leaves[leaf].parent
    while group >= 0 and flow.groups[group].last == leaf:
        if flow.groups[group].hard:
            groups.append(group)
        elif not flow.groups[group].has_limit_or_until:
            groups.clear()
        group = flow.groups[group].parent
    return groups


def _group_facts(study: Study, number: int) -> GroupFacts:
    flow = study.flow
    group = flow.groups[number]
    ended = _reach_verdict(study, flow.round_end_node(number))
    repeats = ended if group.may_repeat else Verdict.NEVER
    if group.hard:
        ends = _reach_verdict(study, flow.time_up_node(number))
    else:
        ends = ended if group.has_limit_or_until else Verdict.NEVER
    return GroupFacts(group=group.name, repeats=repeats, ends=ends)
