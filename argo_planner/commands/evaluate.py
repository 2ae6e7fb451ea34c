"""`argo evaluate`: missions are run many times, and what that says of them is told."""

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.control_variates import (
    ControlledMean,
    run_with_control_variate,
    with_drive,
)
from argo_env.evaluation.folder import (
    COMPARISON,
    FAILING,
    PLAN,
    REPORT,
    digest_contents,
    open_rows,
    read_plan,
    read_results,
    write_failing_specs,
)
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import BACKENDS, PROCESSES
from argo_env.evaluation.rates import Decision
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.runner import EvaluationRunner
from argo_env.evaluation.score import read_scoring
from argo_env.evaluation.store import RowStore
from argo_env.files.folders import check_folder
from argo_env.run.drives_and_sensors import DRIVES, IDEAL, SENSORS
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.evaluation_display import EvaluationDisplay
from argo_planner.terminal.evaluation_request import read_request, require_comparison_only
from argo_planner.terminal.evaluation_tables import show_comparison, show_means, show_results
from argo_planner.terminal.files import check_outputs, read_upload
from argo_planner.terminal.options import EndArea, Force, SiteOption, StartArea
from argo_planner.terminal.signals import Interrupted
from argo_planner.use_cases.evaluating import files_of, make_workers, plan_evaluation


def evaluate(
    context: typer.Context,
    sources: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[FILE.yaml|MISSION...]",
            help="an evaluation's file, or missions as scripts or .json",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="folder for the rows and the report"),
    ] = None,
    seeds: Annotated[str, typer.Option(help="the worlds, such as 0..999")] = "0..99",
    site: SiteOption = "umad",
    drive: Annotated[
        str,
        typer.Option(
            help=f"what moves the robot: {', '.join(DRIVES)}", autocompletion=offer_names(DRIVES)
        ),
    ] = "route",
    sensor: Annotated[
        str,
        typer.Option(
            help=f"what reads the checkpoints: {', '.join(SENSORS)}",
            autocompletion=offer_names(SENSORS),
        ),
    ] = IDEAL,
    faults: Annotated[
        list[str] | None,
        typer.Option(
            "--faults",
            metavar="FILE|DIR|none",
            help="what goes wrong, a case each; a folder for all of its files; several times",
        ),
    ] = None,
    policy: Annotated[
        list[str] | None,
        typer.Option(
            help="in which order tasks are done: `as written`, `optimised`, or module:function"
        ),
    ] = None,
    require: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CLAIM",
            help="what must hold, such as 'success >= 0.98'; stops when it is decided, and exits "
            "with status 1 unless it is met",
        ),
    ] = None,
    width: Annotated[
        float | None,
        typer.Option(help="stop when the intervals of the rates are no wider than this"),
    ] = None,
    control: Annotated[
        str | None,
        typer.Option(
            metavar="DRIVE",
            help="a cheap drive, such as route, whose runs help to estimate what those of --drive "
            "bring, if that pays",
            autocompletion=offer_names(DRIVES),
        ),
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    backend: Annotated[
        str,
        typer.Option(
            help=f"what has the workers: {', '.join(BACKENDS)}",
            autocompletion=offer_names(tuple(BACKENDS)),
        ),
    ] = PROCESSES,
    workers: Annotated[
        int | None,
        typer.Option(help="processes that work at once; all processors if not given", min=1),
    ] = None,
    address: Annotated[
        str | None, typer.Option(help="of a Ray or Dask cluster that is there already")
    ] = None,
    limit: Annotated[
        float | None, typer.Option(help="s that a run may take; it counts as died then", min=1.0)
    ] = None,
    scoring: Annotated[
        Path | None,
        typer.Option(
            "--scoring", metavar="FILE.yaml", help="how missions score; see scenarios/scoring.yaml"
        ),
    ] = None,
    report: Annotated[
        bool, typer.Option("--report/--no-report", help="write the report as a page")
    ] = True,
    compare: Annotated[
        tuple[Path, Path] | None,
        typer.Option(
            "--compare", metavar="DIR DIR", help="two evaluations, pair by pair; runs nothing"
        ),
    ] = None,
    plans: Annotated[
        list[str] | None,
        typer.Option(
            "--plan",
            metavar="NAME",
            help="with --compare: which plan is meant, where an evaluation has several; once for "
            "both, or once for each",
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Estimate the success rate of missions by many runs, or compare two evaluations."""
    console = Console(highlight=False)
    if compare is not None:
        require_comparison_only(context, sources)
        _compare(*compare, plans or [], out, report, force, console)
        return
    if plans:
        raise Invalid("--plan says which plans --compare is about: give it with that")
    rules = read_scoring(scoring)
    file, folder, content = read_request(
        context, sources or [], seeds, site, drive, sensor, faults, policy, require, width,
        control, start_area, end_area,
    )  # fmt: skip
    where = out or Path("out") / "evaluations" / _plain(file.name)
    own = os.path.exists(where / PLAN)
    check_outputs(sources or [], folders=[(where, [REPORT] if report else [])], force=own or force)
    check_folder(where / FAILING)
    digest = digest_contents(*files_of(file, folder), content)
    plan = read_plan(where, digest) or plan_evaluation(file, folder, read_upload)
    helper = None if file.control is None else with_drive(plan, file.control)
    with open_rows(where, plan, digest, replace=force, helper=helper) as store:
        results, means = _carried_out(
            plan, file.control, store, make_workers(plan, backend, workers, address), limit
        )
    failing = write_failing_specs(where, results)
    show_results(results, failing, console, rules)
    show_means(means, file.control, console)
    if report:
        from argo_env.evaluation.report.page import write_evaluation_report  # brings matplotlib

        path = write_evaluation_report(where, results)
        console.print(f"Report: {escape(str(path))}", soft_wrap=True)
    if not any(row.is_completed for row in results.rows):
        print("argo: no run could be carried out: nothing is known of the plans", file=sys.stderr)
        raise typer.Exit(1)
    if any(verdict.verdict is not Decision.MET for verdict in results.verdicts):
        raise typer.Exit(1)


def _carried_out(
    plan: EvaluationPlan,
    control: str | None,
    store: RowStore,
    workers: WorkerBackend,
    limit: float | None,
) -> tuple[EvaluationResults, tuple[ControlledMean, ...]]:
    def made(part: EvaluationPlan) -> EvaluationResults:
        evaluating = EvaluationRunner(part, workers, store, limit=limit)
        for _ in evaluating.rows_as_completed():
            display.show(evaluating.progress)
        return evaluating.results

    try:
        with EvaluationDisplay() as display:
            if control is None:
                return made(plan), ()
            return run_with_control_variate(plan, control, made, store.folder)
    except Interrupted as interrupted:
        print(
            f"argo: interrupted; {len(store.rows)} runs are kept in {store.folder}: the same "
            "command goes on with them",
            file=sys.stderr,
        )
        raise typer.Exit(interrupted.status) from None
    finally:
        workers.close()


def _compare(
    first: Path,
    second: Path,
    plans: list[str],
    out: Path | None,
    report: bool,
    force: bool,
    console: Console,
) -> None:
    from argo_env.evaluation.comparison import compare_plans, find_plan

    where = out or first
    if len(plans) > 2:
        raise Invalid("--compare is about two plans: give --plan once for each of them")
    if report:
        check_outputs((), folders=[(where, [COMPARISON])], force=force)
    a, b = read_results(first), read_results(second)
    names = [None, None] if not plans else [plans[0], plans[-1]]
    chosen = [
        None if name is None else find_plan(results, name)
        for results, name in zip((a, b), names, strict=True)
    ]
    compared = compare_plans(a, b, *chosen)
    if compared.first == compared.second:
        of = compared.first
        compared = replace(compared, first=f"{of} in {first}", second=f"{of} in {second}")
    show_comparison(compared, console)
    if report:
        from argo_env.evaluation.report.page import write_comparison_report

        path = write_comparison_report(where, first, second, compared)
        console.print(f"Report: {escape(str(path))}", soft_wrap=True)


def _plain(name: str) -> str:
    """The name as that of a folder."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in name)
