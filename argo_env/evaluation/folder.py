"""The folder of an evaluation: its plan, its rows, and the specs of what failed."""

import hashlib
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.errors import Invalid, NotFound
from argo_compiler.files.reading import read_bytes
from argo_compiler.files.writing import write_whole
from argo_compiler.model import Model
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.evaluation.store import read_rows
from argo_env.files.folders import make_folder

PLAN = "evaluation.json"
FAILING = "failing"
REPORT = "report.html"
_MOST_FAILING = 1_000
"""specs that are written; the rows of all are there"""
_MAX_BYTES = 1_000_000_000


class _Kept(Model):
    """What is in the file of the plan."""

    digest: str
    """of all that the plan was made from"""
    plan: EvaluationPlan


def keep_plan(folder: Path, plan: EvaluationPlan, digest: str) -> None:
    """Writes the plan of an evaluation. Raises Unavailable where that can't be done."""
    make_folder(folder)
    text = _Kept(digest=digest, plan=plan).model_dump_json(indent=1)
    write_whole(folder / PLAN, text.encode())


def kept_plan(folder: Path, digest: str | None = None) -> EvaluationPlan | None:
    """The plan that is kept in the folder; None if there is none, or with a `digest` none that was
    made from the same. Raises Invalid if it can't be understood."""
    try:
        content = read_bytes(folder / PLAN, "evaluation", _MAX_BYTES)
    except NotFound:
        return None
    try:
        kept = _Kept.model_validate_json(content)
    except ValidationError:
        if digest is not None:
            return None  # of another version of Argo; it is made anew
        raise Invalid(f"{folder / PLAN}: is no plan of an evaluation by this version") from None
    return kept.plan if digest in (None, kept.digest) else None


def read_results(folder: Path) -> EvaluationResults:
    """The evaluation in a folder, as far as it has come.

    Raises NotFound if there is none.
    """
    plan = kept_plan(folder)
    if plan is None:
        raise NotFound(f"{folder}: has no evaluation")
    return EvaluationResults(plan, in_order(plan, read_rows(folder)))


def in_order(plan: EvaluationPlan, rows: tuple[RunRow, ...]) -> tuple[RunRow, ...]:
    """Those rows that are of the plan, seed by seed and case by case."""
    cases = {(case.plan, case.faults): k for k, case in enumerate(plan.cases)}
    seeds = {seed: k for k, seed in enumerate(plan.seeds)}
    by_key = {row.key: row for row in rows}
    found = []
    for row in by_key.values():
        case, seed = cases.get((row.plan, row.faults)), seeds.get(row.seed)
        if case is None or seed is None:
            continue
        if plan.key(plan.run(case, row.seed)) == row.key:
            found.append((seed, case, row))
    return tuple(row for *_, row in sorted(found, key=lambda one: one[:2]))


def write_failing(folder: Path, results: EvaluationResults) -> dict[str, Path]:
    """A file for each run that failed, from which it can be made again alone; by the rows' keys."""
    cases = {(case.plan, case.faults): k for k, case in enumerate(results.plan.cases)}
    written: dict[str, Path] = {}
    for row in results.rows:
        if row.success or len(written) == _MOST_FAILING:
            continue
        run = results.plan.run(cases[row.plan, row.faults], row.seed)
        path = folder / FAILING / f"{row.key}.json"
        if not written:
            make_folder(folder / FAILING)
        write_whole(path, run.spec.model_dump_json(indent=1).encode())
        written[row.key] = path
    return written


def digest_of(*contents: bytes) -> str:
    """Of all that a plan is made from."""
    whole = hashlib.sha256()
    for content in contents:
        whole.update(len(content).to_bytes(8) + content)
    return whole.hexdigest()
