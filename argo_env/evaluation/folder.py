"""Folder of an evaluation: its plan, its rows, and the specs of its unsuccessful runs."""

import hashlib
import os
import re
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, Invalid, NotFound, Remedy
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.files.loading import read_bytes
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.rates import should_stop
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.evaluation.store import RowStore, read_rows
from argo_env.files.checked_files import checked_json, read_checked
from argo_env.files.folders import make_folder, make_private_folder, reporting_write_errors

PLAN = "evaluation.json"
FAILING = "failing"
REPORT = "report.html"
COMPARISON = "comparison.html"
_SPEC_NAME = re.compile(r"[0-9a-f]{24}\.json")
_MAX_FAILING = 1_000
"""largest number of specs that are written; the rows of all runs are in the folder"""
_MAX_BYTES = 1_000_000_000
_REMEDY = Message(
    "restore it from a copy, or delete it and evaluate again, which keeps the rows that fit"
)


class _StoredPlan(Model):
    """Content of the plan's file."""

    digest: str
    """hash of all that the plan was made from"""
    plan: EvaluationPlan


def open_rows(
    folder: Path,
    plan: EvaluationPlan,
    digest: str,
    *,
    replace_and_keep_fitting: bool = False,
    cheap_plan: EvaluationPlan | None = None,
) -> RowStore:
    """Open the rows of an evaluation in its folder for writing, and store its plan beside them.

    An evaluation in the folder is continued if it has the same cases and the same seeds or a subset
    of them; its rule to stop may be another. With `replace_and_keep_fitting`, any
    other evaluation is replaced, and only its rows that belong to the new plan, or to `cheap_plan`,
    are kept.

    Raises Conflict for another evaluation if `replace_and_keep_fitting` is False, or if another
    process evaluates into the folder; Unavailable if the folder can't be written.
    """
    store = RowStore(folder)
    try:
        if not _continues(folder, plan):
            if not replace_and_keep_fitting:
                raise Conflict(
                    Message(
                        "{folder} has another evaluation: choose another folder; or replace its "
                        "plan, and keep those of its rows that fit",
                        folder=folder,
                    ),
                    remedies=(Remedy.CHOOSE_OUTPUT, Remedy.REPLACE),
                )
            plans = (plan,) if cheap_plan is None else (plan, cheap_plan)
            seeds = set(plan.seeds)
            store.keep_only(
                lambda row: any(p.contains(row, seeds if p is plan else {row.seed}) for p in plans)
            )
        write_plan(folder, plan, digest)
    except BaseException:
        store.close()
        raise
    return store


def _continues(folder: Path, plan: EvaluationPlan) -> bool:
    """Return True if the plan can continue the evaluation in the folder, or there is none.

    It can if it differs at most by more seeds and by its rule to stop.
    """
    try:
        stored = find_stored_plan(folder)
    except Invalid:
        return False  # of another version of Argo
    return stored is None or (
        set(stored.seeds) <= set(plan.seeds)
        and stored.with_changes(seeds=plan.seeds, stopping=plan.stopping) == plan
    )


def write_plan(folder: Path, plan: EvaluationPlan, digest: str) -> None:
    """Write the plan of an evaluation into its folder, with the hash of what it was made from.

    Raises Unavailable if the file can't be written.
    """
    make_folder(folder)
    stored = _StoredPlan(digest=digest, plan=plan)
    write_file(folder / PLAN, checked_json(stored.model_dump_json(indent=1)))


def write_file(path: Path, text: str) -> Path:
    """Write a file of an evaluation, which only its owner can read, and return its path.

    Raises Unavailable if the file can't be written.
    """
    with reporting_write_errors(path):
        write_atomically(path, text, private=True)
    return path


def find_stored_plan(folder: Path, digest: str | None = None) -> EvaluationPlan | None:
    """Return the plan stored in the folder, or None if there is none.

    With a `digest` (of `digest_contents`), a plan that was made from other contents also gives
    None, as does a plan of another version of Argo. Without a `digest`, the latter raises Invalid.
    A damaged file raises Unavailable.
    """
    try:
        content = read_bytes(folder / PLAN, "evaluation", _MAX_BYTES)
    except NotFound:
        return None
    try:
        stored = read_checked(_StoredPlan, content, folder / PLAN, _REMEDY)
    except ValidationError:
        if digest is not None:
            return None  # of another version of Argo; the caller makes the plan again
        raise Invalid(
            Message(
                "{folder} is not the plan of an evaluation by this version", folder=folder / PLAN
            )
        ) from None
    return stored.plan if digest in (None, stored.digest) else None


def read_results(folder: Path) -> EvaluationResults:
    """Read the results of the evaluation in a folder, which may be incomplete.

    An evaluation that has not ended gives the worlds before the first world with a missing run.
    Raises NotFound if the folder has no evaluation.
    """
    plan = find_stored_plan(folder)
    if plan is None:
        raise NotFound(Message("{folder} has no evaluation", folder=folder))
    rows = own_rows_in_plan_order(plan, read_rows(folder))
    if plan.strata or len(rows) == len(plan.seeds) * len(plan.cases) or should_stop(plan, rows):
        return EvaluationResults(plan, rows)
    return EvaluationResults.from_worlds_before_first_gap(plan, rows)


def own_rows_in_plan_order(plan: EvaluationPlan, rows: tuple[RunRow, ...]) -> tuple[RunRow, ...]:
    """Return those rows that belong to the plan, in the order of its seeds, then of its cases."""
    seeds = {seed: k for k, seed in enumerate(plan.seeds)}
    by_key = {row.key: row for row in rows}
    own_rows = [row for row in by_key.values() if plan.contains(row, seeds)]
    return tuple(sorted(own_rows, key=lambda row: (seeds[row.seed], plan.case_index(row))))


def replace_failing_specs(folder: Path, results: EvaluationResults) -> dict[str, Path]:
    """Write a spec file for each unsuccessful run, and return the paths by the rows' keys.

    A run can be repeated alone from its file. At most 1,000 files are written; all other spec
    files are removed from the folder.
    """
    paths: dict[str, Path] = {}
    for row in results.rows:
        if row.success or len(paths) == _MAX_FAILING:
            continue
        case = results.plan.case_index(row)
        assert case is not None
        run = results.plan.planned_run(case, row.seed)
        path = folder / FAILING / f"{row.key}.json"
        if not paths:
            with reporting_write_errors(folder / FAILING):
                make_private_folder(folder / FAILING)
        write_file(path, checked_json(run.spec.model_dump_json(indent=1)))
        paths[row.key] = path
    for name in spec_file_names(folder) - {path.name for path in paths.values()}:
        os.unlink(folder / FAILING / name)
    return paths


def spec_file_names(folder: Path) -> frozenset[str]:
    """Return the names of the files with specs of unsuccessful runs in an evaluation's folder."""
    specs = folder / FAILING
    names = os.listdir(specs) if os.path.isdir(specs) else ()
    return frozenset(name for name in names if _SPEC_NAME.fullmatch(name))


def digest_contents(*contents: bytes) -> str:
    """Return a hash of the contents of all files that a plan is made from."""
    digest = hashlib.sha256()
    for content in contents:
        digest.update(len(content).to_bytes(8) + content)
    return digest.hexdigest()
