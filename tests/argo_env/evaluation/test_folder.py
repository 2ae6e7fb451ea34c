"""Tests of an evaluation's folder: the plans that it accepts, and the rows that it keeps."""

import random

import pytest

from argo_compiler.base.errors import Conflict, Unavailable
from argo_env.evaluation.control_variates import make_cheap_plan
from argo_env.evaluation.folder import digest_contents, find_stored_plan, open_rows, read_results
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.rates import IntervalMethod
from argo_env.evaluation.runner import WorkOrder
from argo_env.evaluation.store import read_rows
from tests.argo_env.evaluation import work
from tests.argo_env.evaluation.conftest import plan_of

DIGEST = digest_contents(b"")


@pytest.fixture(scope="module")
def plan(mission) -> EvaluationPlan:
    return plan_of(mission, range(12), drive="kinematic", name="short")


def rows_of(plan, seeds=None):
    """Return invented rows of the plan's runs."""
    return [
        work.invented(WorkOrder(plan.key(run), plan.cases[run.case], run.spec, {}))
        for run in plan.runs(seeds)
    ]


def fill(folder, plan, *more):
    """Fill the folder with all rows of the plan in a Parquet file, and `more` rows in the log."""
    with open_rows(folder, plan, DIGEST) as store:
        for row in rows_of(plan):
            store.add_if_new(row)
        store.compact()
        for row in more:
            store.add_if_new(row)


def keys(folder):
    return {row.key for row in read_rows(folder)}


@pytest.mark.parametrize(
    "change",
    [{}, {"seeds": tuple(range(20))}, {"stopping": Stopping(width=0.1)}],
    ids=["the same", "more seeds", "another end"],
)
def test_an_evaluation_is_continued(tmp_path, plan, change):
    fill(tmp_path, plan)
    with open_rows(tmp_path, plan.with_changes(**change), DIGEST) as store:
        assert len(store.rows) == 12
    assert find_stored_plan(tmp_path) == plan.with_changes(**change)


def test_incomplete_results_have_the_worlds_before_the_first_gap(tmp_path, plan):
    fill(tmp_path, plan.with_changes(seeds=(0, 1, 2, 3, 5, 6)))
    open_rows(tmp_path, plan, DIGEST).close()
    results = read_results(tmp_path)
    assert results.cut_short
    assert [row.seed for row in results.rows] == [0, 1, 2, 3]
    assert results.rate(plan.plans[0]).method is IntervalMethod.SEQUENCE
    fill(tmp_path, plan)
    results = read_results(tmp_path)
    assert not results.cut_short
    assert results.rate(plan.plans[0]).method is IntervalMethod.EXACT


@pytest.mark.parametrize("seeds", [range(5), range(5, 30)])
def test_another_evaluation_is_refused_and_changes_nothing(tmp_path, plan, seeds):
    fill(tmp_path, plan)
    other = plan.with_changes(seeds=tuple(seeds))
    with pytest.raises(Conflict, match="has another evaluation"):
        open_rows(tmp_path, other, DIGEST)
    assert find_stored_plan(tmp_path) == plan
    assert len(keys(tmp_path)) == 12
    # The refused evaluation must release the folder's lock.
    open_rows(tmp_path, plan, DIGEST).close()


def test_a_replaced_evaluation_keeps_the_rows_that_fit(tmp_path, plan):
    later = rows_of(plan.with_changes(seeds=(100, 101)))
    fill(tmp_path, plan, *later)
    other = plan.with_changes(seeds=(3, 4, 5, 100))
    with open_rows(tmp_path, other, DIGEST, replace_and_keep_fitting=True) as store:
        assert {row.seed for row in store.rows.values()} == {3, 4, 5, 100}
        store.add_if_new(rows_of(other.with_changes(seeds=(200,)))[0])
        store.compact()
    assert len(keys(tmp_path)) == 5
    assert [row.seed for row in read_results(tmp_path).rows] == [3, 4, 5, 100]


def test_cheap_runs_stay_with_the_plan_that_they_help(tmp_path, plan):
    cheap = make_cheap_plan(plan, "route")
    fill(tmp_path, plan, *rows_of(cheap, (0, 1, 5_000)))
    other = plan.with_changes(seeds=tuple(range(20, 40)))
    with open_rows(
        tmp_path, other, DIGEST, replace_and_keep_fitting=True, cheap_plan=cheap
    ) as store:
        assert sorted((row.seed, row.drive) for row in store.rows.values()) == [
            (0, "route"), (1, "route"), (5_000, "route"),
        ]  # fmt: skip


@pytest.mark.parametrize("checked", [True, False])
@pytest.mark.parametrize("cut", [300, 1])
def test_a_plan_that_was_cut_is_damaged_and_not_another_one(tmp_path, plan, checked, cut):
    fill(tmp_path, plan)
    path = tmp_path / "evaluation.json"
    text = path.read_text()
    if not checked:
        text = "{" + text.partition(",")[2]
    path.write_text(text)
    assert find_stored_plan(tmp_path) == plan
    path.write_text(text[:-cut])
    says = (
        rf"evaluation\.json is damaged: line {text.count(chr(10)) - text[-cut:].count(chr(10)) + 1}"
    )
    for act in (
        lambda: find_stored_plan(tmp_path),
        lambda: find_stored_plan(tmp_path, DIGEST),
        lambda: open_rows(tmp_path, plan, DIGEST),
        lambda: read_results(tmp_path),
    ):
        with pytest.raises(Unavailable, match=says) as caught:
            act()
        assert "delete it and evaluate again, which keeps the rows that fit" in str(caught.value)
    path.unlink()
    with open_rows(tmp_path, plan, DIGEST) as store:
        assert len(store.rows) == 12


def test_each_flipped_bit_of_the_plan_is_damage(tmp_path, plan):
    fill(tmp_path, plan)
    path = tmp_path / "evaluation.json"
    content = path.read_bytes()
    rng = random.Random(18)
    for _ in range(100):
        damaged = bytearray(content)
        damaged[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
        path.write_bytes(damaged)
        with pytest.raises(Unavailable, match=r"evaluation\.json is damaged: "):
            read_results(tmp_path)


def test_a_plan_of_another_version_is_another_evaluation(tmp_path, plan):
    fill(tmp_path, plan)
    (tmp_path / "evaluation.json").write_text('{"version": 0}')
    with pytest.raises(Conflict, match="has another evaluation"):
        open_rows(tmp_path, plan, DIGEST)
    open_rows(tmp_path, plan, DIGEST, replace_and_keep_fitting=True).close()
    assert find_stored_plan(tmp_path) == plan
    assert len(keys(tmp_path)) == 12
