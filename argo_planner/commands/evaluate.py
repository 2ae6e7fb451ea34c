"""`argo evaluate`: missions are run many times, and what that says of them is told."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.errors import Conflict, Invalid, Remedy
from argo_compiler.files.reading import read_bytes
from argo_env.evaluation.controlled import ControlledMean, run_controlled, with_drive
from argo_env.evaluation.evaluating import Evaluating
from argo_env.evaluation.file import MAX_BYTES, EvaluationFile, MissionEntry, decode_evaluation
from argo_env.evaluation.folder import (
    PLAN,
    digest_of,
    keep_plan,
    kept_plan,
    read_results,
    write_failing,
)
from argo_env.evaluation.plan import AS_WRITTEN, NO_FAULTS, EvaluationPlan
from argo_env.evaluation.pool.backends import BACKENDS, PROCESSES, make_backend
from argo_env.evaluation.rates import Decision
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.score import read_scoring
from argo_env.evaluation.store import RowStore
from argo_env.run.drives_and_sensors import DRIVES, IDEAL, SENSORS
from argo_planner.terminal.completion import among
from argo_planner.terminal.evaluation_display import EvaluationDisplay
from argo_planner.terminal.evaluation_tables import show_comparison, show_means, show_results
from argo_planner.terminal.files import read_upload
from argo_planner.terminal.options import EndArea, Force, SiteOption, StartArea
from argo_planner.use_cases.evaluating import plan_evaluation

_YAML = (".yaml", ".yml")


def evaluate(
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
            help=f"what moves the robot: {', '.join(DRIVES)}", autocompletion=among(DRIVES)
        ),
    ] = "route",
    sensor: Annotated[
        str,
        typer.Option(
            help=f"what reads the checkpoints: {', '.join(SENSORS)}", autocompletion=among(SENSORS)
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
            autocompletion=among(DRIVES),
        ),
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    backend: Annotated[
        str,
        typer.Option(
            help=f"what has the workers: {', '.join(BACKENDS)}",
            autocompletion=among(tuple(BACKENDS)),
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
    force: Force = False,
) -> None:
    """Run missions many times: how sure they work, what breaks them, which is better."""
    console = Console(highlight=False)
    if compare is not None:
        if sources:
            raise Invalid("--compare is about evaluations that are there: give no missions")
        _compare(*compare, report, console)
        return
    rules = read_scoring(scoring)
    file, folder, content = _asked_for(
        sources or [], seeds, site, drive, sensor, faults, policy, require, width,
        control, start_area, end_area,
    )  # fmt: skip
    where = out or Path("out") / "evaluations" / _plain(file.name)
    plan = _planned(file, folder, content, where, force)
    if file.control is not None:
        with_drive(plan, file.control)  # what it can't have is told before anything runs
    results, means = _carried_out(plan, file.control, where, backend, workers, address, limit)
    failing = write_failing(where, results)
    show_results(results, failing, console, rules)
    show_means(means, file.control, console)
    if report:
        from argo_env.evaluation.report.page import write_evaluation_report  # brings matplotlib

        path = write_evaluation_report(where, results)
        console.print(f"Report: {escape(str(path))}", soft_wrap=True)
    if any(verdict.verdict is not Decision.MET for verdict in results.verdicts):
        raise typer.Exit(1)


def _asked_for(
    sources: list[Path],
    seeds: str,
    site: str,
    drive: str,
    sensor: str,
    faults: list[str] | None,
    policies: list[str] | None,
    require: list[str] | None,
    width: float | None,
    control: str | None,
    start_area: int | None,
    end_area: int | None,
) -> tuple[EvaluationFile, Path, bytes]:
    """What is to be evaluated, the folder that its paths begin in, and the text of its file."""
    if not sources:
        raise Invalid("give an evaluation's file, or missions; see `argo evaluate --help`")
    described = [source for source in sources if source.suffix in _YAML]
    if described:
        if len(sources) > 1:
            raise Invalid(f"{described[0]}: an evaluation's file stands alone: give nothing else")
        path = described[0]
        content = read_bytes(path, "evaluation", MAX_BYTES)
        return decode_evaluation(content, str(path)), path.parent, content
    missions = tuple(
        MissionEntry(file=str(source), start_area=start_area, end_area=end_area)
        for source in sources
    )
    data = {
        "name": " and ".join(source.stem for source in sources),
        "missions": missions,
        "sites": (site,),
        "drives": (drive,),
        "sensors": (sensor,),
        "policies": tuple(policies or (AS_WRITTEN,)),
        "faults": tuple(faults or (NO_FAULTS,)),
        "seeds": seeds,
        "require": tuple(require or ()),
        "stop": {"width": width},
        "control": control,
    }
    return _validated(data), Path(), b""


def _validated(data: Mapping[str, object]) -> EvaluationFile:
    from pydantic import ValidationError

    try:
        return EvaluationFile.model_validate(data)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        raise Invalid(str(fault["msg"]).removeprefix("Value error, ")) from None


def _planned(
    file: EvaluationFile, folder: Path, content: bytes, where: Path, force: bool
) -> EvaluationPlan:
    """The plan, which is the one that is there already if it was made from the same."""
    read = [content, file.model_dump_json().encode()]
    for said in file.missions:
        path = folder / (said if isinstance(said, str) else said.file)
        if os.path.isfile(path):
            read.append(path.read_bytes())
    digest = digest_of(*read)
    before = kept_plan(where, digest)
    plan = before or plan_evaluation(file, folder, read_upload)
    if before is None:
        other = os.path.exists(where / PLAN) and kept_plan(where) not in (None, plan)
        if other and not force:
            raise Conflict(
                f"{where}: has another evaluation: choose another folder with --out; or replace "
                "its plan, and keep those of its rows that fit",
                remedies=(Remedy.REPLACE,),
            )
        keep_plan(where, plan, digest)
    return plan


def _carried_out(
    plan: EvaluationPlan,
    control: str | None,
    where: Path,
    backend: str,
    workers: int | None,
    address: str | None,
    limit: float | None,
) -> tuple[EvaluationResults, tuple[ControlledMean, ...]]:
    with RowStore(where) as store, EvaluationDisplay() as display:
        has = make_backend(backend, workers, address)

        def made(part: EvaluationPlan) -> EvaluationResults:
            evaluating = Evaluating(part, has, store, limit=limit)
            for _ in evaluating.rows_as_they_come():
                display.show(evaluating.progress)
            return evaluating.results

        try:
            if control is None:
                return made(plan), ()
            return run_controlled(plan, control, made, where)
        finally:
            has.close()


def _compare(first: Path, second: Path, report: bool, console: Console) -> None:
    from argo_env.evaluation.comparison import compare_plans

    a, b = read_results(first), read_results(second)
    compared = compare_plans(a, b)
    show_comparison(compared, console)
    if report:
        from argo_env.evaluation.report.page import write_comparison_report

        path = write_comparison_report(first, second, compared)
        console.print(f"Report: {escape(str(path))}", soft_wrap=True)


def _plain(name: str) -> str:
    """The name as that of a folder."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in name)
