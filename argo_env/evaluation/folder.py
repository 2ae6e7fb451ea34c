"""The folder of an evaluation: its plan, its rows, and the specs of what failed."""

import hashlib
import os
import re
from collections.abc import Collection
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, Invalid, NotFound, Remedy
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.files.loading import read_bytes
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.rates import is_enough
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.evaluation.store import RowStore, read_rows
from argo_env.files.folders import make_folder, writing

PLAN = "evaluation.json"
FAILING = "failing"
REPORT = "report.html"
COMPARISON = "comparison.html"
_SPEC = re.compile(r"[0-9a-f]{24}\.json")
_MOST_FAILING = 1_000
"""specs that are written; the rows of all are there"""
_MAX_BYTES = 1_000_000_000


class _Kept(Model):
    """What is in the file of the plan."""

    digest: str
    """of all that the plan was made from"""
    plan: EvaluationPlan


def open_rows(
    folder: Path,
    plan: EvaluationPlan,
    digest: str,
    *,
    replace: bool = False,
    helper: EvaluationPlan | None = None,
) -> RowStore:
    """The rows of an evaluation in its folder, opened for writing, with the plan kept beside them;
    `helper` is the plan of cheap runs that help it.

    An evaluation that is there goes on if it is the same, or has the same cases and fewer seeds.
    Any other one gives way if it is to be replaced: of its rows those stay that fit.

    Raises Conflict for another evaluation that is not to be replaced, or if another process
    evaluates into the folder; Unavailable if it can't be written.
    """
    store = RowStore(folder)
    try:
        if not _goes_on(folder, plan):
            if not replace:
                raise Conflict(
                    f"{folder}: has another evaluation: choose another folder; or replace its "
                    "plan, and keep those of its rows that fit",
                    remedies=(Remedy.CHOOSE_OUTPUT, Remedy.REPLACE),
                )
            plans = (plan,) if helper is None else (plan, helper)
            seeds = set(plan.seeds)
            store.keep_only(
                lambda row: any(one.has(row, seeds if one is plan else {row.seed}) for one in plans)
            )
        keep_plan(folder, plan, digest)
    except BaseException:
        store.close()
        raise
    return store


def _goes_on(folder: Path, plan: EvaluationPlan) -> bool:
    """Whether the plan goes on with what is in the folder, if there is anything."""
    try:
        before = kept_plan(folder)
    except Invalid:
        return False  # of another version of Argo
    return before is None or (
        set(before.seeds) <= set(plan.seeds)
        and before.changed(seeds=plan.seeds, stopping=plan.stopping) == plan
    )


def keep_plan(folder: Path, plan: EvaluationPlan, digest: str) -> None:
    """Writes the plan of an evaluation. Raises Unavailable where that can't be done."""
    make_folder(folder)
    write_file(folder / PLAN, _Kept(digest=digest, plan=plan).model_dump_json(indent=1))


def write_file(path: Path, text: str) -> Path:
    """Writes a file of an evaluation and returns its path. Raises Unavailable where that can't be
    done."""
    with writing(path):
        write_atomically(path, text)
    return path


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
    """The evaluation in a folder, as far as it has come: of one that is not at its end the worlds
    before the first one in which a run is missing.

    Raises NotFound if there is none.
    """
    plan = kept_plan(folder)
    if plan is None:
        raise NotFound(f"{folder}: has no evaluation")
    rows = in_order(plan, read_rows(folder))
    if plan.strata or len(rows) == len(plan.seeds) * len(plan.cases) or is_enough(plan, rows):
        return EvaluationResults(plan, rows)
    return EvaluationResults.so_far(plan, rows)


def in_order(plan: EvaluationPlan, rows: tuple[RunRow, ...]) -> tuple[RunRow, ...]:
    """Those rows that are of the plan, seed by seed and case by case."""
    seeds = {seed: k for k, seed in enumerate(plan.seeds)}
    by_key = {row.key: row for row in rows}
    found = [row for row in by_key.values() if plan.has(row, seeds)]
    return tuple(sorted(found, key=lambda row: (seeds[row.seed], plan.case_of(row))))


def write_failing(folder: Path, results: EvaluationResults) -> dict[str, Path]:
    """A file for each run that failed, from which it can be made again alone; by the rows' keys.
    Those of runs that are none of the evaluation's any more are removed."""
    written: dict[str, Path] = {}
    for row in results.rows:
        if row.success or len(written) == _MOST_FAILING:
            continue
        case = results.plan.case_of(row)
        assert case is not None
        run = results.plan.run(case, row.seed)
        path = folder / FAILING / f"{row.key}.json"
        if not written:
            make_folder(folder / FAILING)
        write_file(path, run.spec.model_dump_json(indent=1))
        written[row.key] = path
    _remove_others(folder / FAILING, {path.name for path in written.values()})
    return written


def _remove_others(folder: Path, names: Collection[str]) -> None:
    """Removes the specs of other runs from the folder."""
    for name in os.listdir(folder) if os.path.isdir(folder) else ():
        if _SPEC.fullmatch(name) and name not in names:
            os.unlink(folder / name)


def digest_of(*contents: bytes) -> str:
    """Of all that a plan is made from."""
    whole = hashlib.sha256()
    for content in contents:
        whole.update(len(content).to_bytes(8) + content)
    return whole.hexdigest()
