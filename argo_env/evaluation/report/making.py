"""How an evaluation was made, without the time of day: equal rows have an equal report."""

from argo_compiler.base.version import __version__
from argo_env.evaluation.report.words import counted, ranges
from argo_env.evaluation.results import EvaluationResults


def how_it_was_made(results: EvaluationResults) -> list[tuple[str, list[str]]]:
    """What was run, by name."""
    plan = results.plan
    cases = plan.cases
    names = {
        "Missions": [case.mission for case in cases],
        "Order of tasks": [case.policy for case in cases],
        "Sites": [case.spec.site for case in cases],
        "Robots": [case.spec.robot for case in cases],
        "Drives": [case.spec.drive for case in cases],
        "Sensors": [case.spec.sensor for case in cases],
        "Faults": [_weighted(case.faults, case.weight) for case in cases],
    }
    made = [(what, list(dict.fromkeys(said))) for what, said in names.items()]
    if plan.added:
        made.append(("On the site", [plan.added]))
    asked = len(cases) * len(plan.seeds)
    made.append(("Seeds", [ranges(plan.seeds)]))
    made.append(("Runs", [f"{len(results.rows)} of {asked} that there may be"]))
    if results.cut_short:
        made.append(("Ended", ["before its time; told are the worlds of which no run is missing"]))
    stopping = []
    if plan.stopping.require:
        stopping.append("when all that was required is decided")
    if plan.stopping.width is not None:
        stopping.append(f"when all intervals are no wider than {100 * plan.stopping.width:g} %")
    if stopping:
        looked = f"one looks after {counted(plan.stopping.every, 'seed')}"
        made.append(("Stops", [*stopping, looked]))
    made.append(("Argo", [__version__]))
    return made


def _weighted(name: str, weight: float) -> str:
    return name if weight == 1.0 else f"{name} (weight {weight:g})"
