"""`argo evaluate`: run missions many times and estimate their success rates."""

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.base.errors import Invalid
from argo_compiler.base.quantity_text import counted_text
from argo_env.evaluation.control_variates import (
    ControlledMean,
    make_cheap_plan,
    run_with_control_variate,
)
from argo_env.evaluation.folder import (
    COMPARISON,
    FAILING,
    PLAN,
    REPORT,
    digest_contents,
    find_stored_plan,
    open_rows,
    read_results,
    replace_failing_specs,
)
from argo_env.evaluation.plan import EvaluationPlan, single_seed_note
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import BACKENDS, PROCESSES
from argo_env.evaluation.rates import Decision
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.runner import EvaluationRunner
from argo_env.evaluation.score import read_scoring
from argo_env.evaluation.store import RowStore
from argo_env.files.folders import require_folder_or_creatable
from argo_env.run.drives_and_sensors import IDEAL, SENSORS, drive_names
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.evaluation_display import EvaluationDisplay
from argo_planner.terminal.evaluation_request import (
    read_evaluation_request,
    require_comparison_only,
)
from argo_planner.terminal.evaluation_tables import show_comparison, show_means, show_results
from argo_planner.terminal.files import check_outputs, read_upload
from argo_planner.terminal.options import EndArea, Force, SiteOption, StartArea, read_duration
from argo_planner.terminal.signals import Interrupted
from argo_planner.use_cases.evaluating import contents_for_digest, make_workers, plan_evaluation


def evaluate_command(
    context: typer.Context,
    sources: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[FILE.yaml|MISSION...]",
            help="evaluation file (.yaml), or missions: scripts or .json",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="folder for the results; out/evaluations/NAME if not given"
        ),
    ] = None,
    seeds: Annotated[
        str, typer.Option(help="seeds of the simulated worlds, such as 0..999")
    ] = "0..99",
    site: SiteOption = "umad",
    drive: Annotated[
        str,
        typer.Option(
            help=f"model of the robot's motion: {', '.join(drive_names())}",
            autocompletion=offer_names(drive_names),
        ),
    ] = "route",
    sensor: Annotated[
        str,
        typer.Option(
            help=f"how checkpoints are read: {', '.join(SENSORS)}",
            autocompletion=offer_names(SENSORS.names),
        ),
    ] = IDEAL,
    faults: Annotated[
        list[str] | None,
        typer.Option(
            "--faults",
            metavar="FILE|DIR|none",
            help="file of faults, or a folder with such files, or none; each file is a case of its "
            "own; can be given several times",
        ),
    ] = None,
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="order of the tasks: `as written`, `optimised`, the name of an installed policy, "
            "or a function as module:function"
        ),
    ] = None,
    require: Annotated[
        list[str] | None,
        typer.Option(
            metavar="REQUIREMENT",
            help="requirement, such as 'success >= 0.98'; the runs stop when it is decided; exits "
            "with status 1 unless it is met",
        ),
    ] = None,
    width: Annotated[
        float | None,
        typer.Option(
            help="stop when the 95 % intervals of all rates have at most this width, such as 0.02"
        ),
    ] = None,
    control: Annotated[
        str | None,
        typer.Option(
            metavar="DRIVE",
            help="fast drive, such as route; many runs with it make the estimates for --drive more "
            "precise, if that saves time",
            autocompletion=offer_names(drive_names),
        ),
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    backend: Annotated[
        str,
        typer.Option(
            help=f"where the runs are computed: {', '.join(BACKENDS)}",
            autocompletion=offer_names(lambda: BACKENDS),
        ),
    ] = PROCESSES,
    workers: Annotated[
        int | None,
        typer.Option(help="number of parallel processes; one per processor if not given", min=1),
    ] = None,
    address: Annotated[
        str | None, typer.Option(help="address of a running Ray or Dask cluster")
    ] = None,
    limit: Annotated[
        float | None,
        typer.Option(
            parser=read_duration(least=1.0),
            metavar="TIME",
            help="longest time of a run, such as 10min; a number is in s; a longer run counts as "
            "died",
        ),
    ] = None,
    scoring: Annotated[
        Path | None,
        typer.Option(
            "--scoring", metavar="FILE.yaml", help="scoring rules, such as the example `scoring`"
        ),
    ] = None,
    report: Annotated[
        bool, typer.Option("--report/--no-report", help="write the report as a web page")
    ] = True,
    compare: Annotated[
        Path | None,
        typer.Option(
            "--compare",
            metavar="DIR [DIR]",
            help="compare two evaluations by their folders, or two plans of one; runs nothing",
        ),
    ] = None,
    plans: Annotated[
        list[str] | None,
        typer.Option(
            "--plan",
            metavar="NAME",
            help="with --compare: name of the plan, if an evaluation has several; give it once for "
            "both evaluations, or once for each; a single evaluation with two plans needs none",
        ),
    ] = None,
    trust: Annotated[
        bool,
        typer.Option(
            "--trust",
            help="let FILE.yaml name policies as module:function, whose code is run, and files "
            "outside of its folder",
        ),
    ] = False,
    force: Force = False,
) -> None:
    """Estimate the success rate of missions by many runs, or compare two evaluations."""
    console = Console(highlight=False)
    if compare is not None:
        require_comparison_only(context, sources)
        _compare(compare, sources[0] if sources else None, plans or [], out, report, force, console)
        return
    if plans:
        raise Invalid(
            "--plan chooses plans for --compare: give --compare as well, or leave --plan out"
        )
    rules = read_scoring(scoring)
    file, folder, content = read_evaluation_request(
        context, sources or [], seeds, site, drive, sensor, faults, policy, require, width,
        control, start_area, end_area, trust,
    )  # fmt: skip
    target = out or Path("out") / "evaluations" / _folder_name(file.name)
    continues = os.path.exists(target / PLAN)
    check_outputs(
        sources or [], folders=[(target, [REPORT] if report else [])], force=continues or force
    )
    require_folder_or_creatable(target / FAILING)
    digest = digest_contents(*contents_for_digest(file, folder), content)
    if note := single_seed_note(str(file.seeds)):
        print(f"argo: {note}", file=sys.stderr)
    plan = find_stored_plan(target, digest) or plan_evaluation(
        file, folder, read_upload, policy_folder=folder
    )
    cheap_plan = None if file.control is None else make_cheap_plan(plan, file.control)
    with open_rows(
        target, plan, digest, replace_and_keep_fitting=force, cheap_plan=cheap_plan
    ) as store:
        if store.loss:
            print(f"argo: {store.loss}: the lost runs are repeated", file=sys.stderr)
        results, means = _run_evaluation(
            plan, file.control, store, make_workers(plan, backend, workers, address), limit
        )
    failing = replace_failing_specs(target, results)
    show_results(results, failing, console, rules)
    show_means(means, file.control, console)
    if report:
        from argo_env.evaluation.report.page import write_evaluation_report  # imports matplotlib

        path = write_evaluation_report(target, results)
        console.print(f"Report: {escape(str(path))}", soft_wrap=True)
    if not any(row.is_completed for row in results.rows):
        print("argo: no run could be carried out, so there are no results", file=sys.stderr)
        raise typer.Exit(1)
    if any(verdict.verdict is not Decision.MET for verdict in results.verdicts):
        raise typer.Exit(1)


def _run_evaluation(
    plan: EvaluationPlan,
    control: str | None,
    store: RowStore,
    workers: WorkerBackend,
    limit: float | None,
) -> tuple[EvaluationResults, tuple[ControlledMean, ...]]:
    def make_runs(part: EvaluationPlan) -> EvaluationResults:
        runner = EvaluationRunner(part, workers, store, limit=limit)
        for _ in runner.rows_as_completed():
            display.show(runner.progress)
        return runner.results

    try:
        with EvaluationDisplay() as display:
            if control is None:
                return make_runs(plan), ()
            return run_with_control_variate(plan, control, make_runs, store.folder)
    except Interrupted as interrupted:
        print(
            f"argo: interrupted; {counted_text(len(store.rows), 'run')} stored in {store.folder}: "
            "repeat the command to continue",
            file=sys.stderr,
        )
        raise typer.Exit(interrupted.status) from None
    finally:
        workers.close()


def _compare(
    first: Path,
    second: Path | None,
    plans: list[str],
    out: Path | None,
    report: bool,
    force: bool,
    console: Console,
) -> None:
    from argo_env.evaluation.comparison import compare_plans, plan_by_label_or_mission

    target = out or first
    if len(plans) > 2:
        raise Invalid("--compare takes two plans: give --plan at most twice")
    if report:
        check_outputs((), folders=[(target, [COMPARISON])], force=force)
    a = read_results(first)
    if second is None:
        plans, second = _two_plans(a, plans), first
    b = read_results(second)
    names = [None, None] if not plans else [plans[0], plans[-1]]
    chosen = [
        None if name is None else plan_by_label_or_mission(results, name)
        for results, name in zip((a, b), names, strict=True)
    ]
    compared = compare_plans(a, b, *chosen)
    if compared.first == compared.second:
        name = compared.first
        compared = replace(compared, first=f"{name} in {first}", second=f"{name} in {second}")
    show_comparison(compared, console)
    if report:
        from argo_env.evaluation.report.page import write_comparison_report

        path = write_comparison_report(target, first, second, compared)
        console.print(f"Report: {escape(str(path))}", soft_wrap=True)


def _two_plans(results: EvaluationResults, plans: list[str]) -> list[str]:
    """Return the names of the two plans of one evaluation to compare; raise Invalid without two."""
    known = [str(plan.label(results.plan.plans)) for plan in results.plan.plans]
    chosen = plans or known
    if len(set(chosen)) != 2:
        raise Invalid(
            f"--compare {results.plan.name}: name two of its plans by --plan, or a second "
            f"evaluation; there are: {'; '.join(known)}"
        )
    return chosen


def _folder_name(name: str) -> str:
    """Return the name of a folder: that of an evaluation, with `-` for unsuitable characters."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in name)
