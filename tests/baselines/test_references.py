"""References: what is known of the best routes, which never gets worse."""

import json
from dataclasses import replace

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import RouteSuggestion, Tour, evaluate
from argo_env.envs.route_noise import RouteNoise
from baselines import references
from baselines.episodes import play
from baselines.families import TEST_SETS, InstanceFamily, InstanceSet
from baselines.policy import make_policy
from baselines.problem import hindsight
from baselines.references import BestKnown, Effort, improve, improved

NUMBER = 1_000_003
QUICK = Effort(2.0, searches=1)


def instances_of(name, family, count=1):
    return InstanceSet(name, family, range(NUMBER, NUMBER + count))


SMALL = instances_of("small", InstanceFamily(8, budget=600.0))
NOISY = instances_of(
    "noisy", InstanceFamily(8, budget=600.0, noise=RouteNoise(failing=0.4, blocked=2))
)


def problem_of(tests, number=NUMBER):
    return hindsight(tests.family.source.draw(number)).problem


def finds(monkeypatch, order, prize, bound):
    """The optimiser finds this, whatever it is asked."""
    found = RouteSuggestion(Tour(order), prize, bound, 0, 0, prize == bound)
    monkeypatch.setattr(references, "suggest_route", lambda *_, **__: found)


@pytest.mark.parametrize("name", TEST_SETS)
def test_routes_that_are_known_win_what_is_said(name):
    """Checked by the definition of what a route means, for a tenth of the instances."""
    tests = TEST_SETS[name]
    for number, best in list(zip(tests.numbers, references.references(name), strict=True))[::10]:
        if best.route:
            problem = problem_of(tests, number)
            value = evaluate(problem, Tour(tuple(node - 1 for node in best.route)))
            assert value.feasible
            assert value.prize / 100 == pytest.approx(best.prize)
            assert value.duration * problem.unit == best.time
        assert best.proven == (best.prize == best.bound)


@pytest.mark.parametrize("tests", [SMALL, NOISY], ids=["small", "noisy"])
def test_a_new_reference_is_a_route_with_its_proof(tests):
    best = improved(tests, NUMBER, None, QUICK)
    assert best.proven
    value = evaluate(problem_of(tests), Tour(tuple(node - 1 for node in best.route)))
    assert value.feasible
    assert value.prize / 100 == pytest.approx(best.prize)


def test_the_best_of_all_that_is_found_is_kept(monkeypatch):
    best = improved(SMALL, NUMBER, None, QUICK)
    most = round(100 * best.prize)
    # A search that finds nothing much: a route that was known, one that is given, or a policy's.
    finds(monkeypatch, (), 0, most)
    monkeypatch.setattr(references, "insert_and_improve", lambda _: ())
    assert improved(SMALL, NUMBER, replace(best, bound=9.9), QUICK) == best
    assert improved(SMALL, NUMBER, None, QUICK, [best.route, (1,)]) == best
    lazy = improved(SMALL, NUMBER, None, QUICK)
    assert lazy.prize == 0.0
    assert not lazy.proven
    (outcome,) = play(make_policy("nearest-neighbour"), SMALL, 1)
    driven = improved(SMALL, NUMBER, lazy, Effort(1.0, 1, ("nearest-neighbour",)))
    assert driven.prize == pytest.approx(outcome.prize)
    assert driven.route == outcome.route[:-1]


def test_routes_that_are_not_feasible_count_for_nothing(monkeypatch):
    best = improved(SMALL, NUMBER, None, QUICK)
    finds(monkeypatch, (), 0, round(100 * best.prize))
    every = tuple(range(1, 9))
    assert not evaluate(problem_of(SMALL), Tour(tuple(n - 1 for n in every))).feasible
    assert improved(SMALL, NUMBER, best, QUICK, [every, (1, 1)]) == best


def test_of_equal_prizes_the_shorter_route_is_kept():
    best = improved(SMALL, NUMBER, None, QUICK)
    longer = replace(best, time=best.time + 1.0)
    assert improved(SMALL, NUMBER, longer, QUICK, [best.route]) == best


def test_what_is_proven_is_not_searched_again(monkeypatch):
    best = improved(SMALL, NUMBER, None, QUICK)
    monkeypatch.setattr(references, "suggest_route", None)
    assert improved(SMALL, NUMBER, best, QUICK) == best


def test_a_bound_that_a_route_exceeds_is_an_error(monkeypatch):
    best = improved(SMALL, NUMBER, None, QUICK)
    finds(monkeypatch, (), 0, 10)
    with pytest.raises(ArgoError, match=r"none is said to win more than 0\.1: the optimiser is"):
        improved(SMALL, NUMBER, replace(best, bound=9.9), QUICK)


def test_a_file_of_references_never_gets_worse(tmp_path):
    tests, file = instances_of("two", InstanceFamily(6, budget=500.0), 2), tmp_path / "two.json"
    improve(tests, file, QUICK)
    first = json.loads(file.read_text())
    assert first["checksum"] == tests.checksum()
    assert len(first["instances"]) == 2
    improve(tests, file, QUICK, processes=2)
    assert json.loads(file.read_text()) == first
    # One that was found for other instances counts for nothing.
    rich = first | {"checksum": "other"}
    rich["instances"] = [one | {"prize": 99.0, "bound": 99.0} for one in first["instances"]]
    file.write_text(json.dumps(rich))
    improve(tests, file, QUICK)
    assert json.loads(file.read_text()) == first


def test_routes_of_results_are_read_by_instance(tmp_path):
    route = [3, 1, 3, 2, 0]  # the first reading of checkpoint 3 failed
    outcomes = {"mine": [{"instance": 7, "route": route}], "other": [{"instance": 7, "route": [0]}]}
    results = [{"test_set": "a", "outcomes": outcomes}, {"test_set": "b", "outcomes": {}}]
    (tmp_path / "results.json").write_text(json.dumps(results))
    assert references.routes_of([tmp_path / "results.json"], "a") == {7: [(1, 3, 2), ()]}
    assert references.routes_of([tmp_path / "results.json"], "b") == {}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["random-21"], "no test set `random-21`"),
        (["random-20-v1", "--results", "nowhere.json"], "nowhere.json can't be read"),
        (["random-20-v1", "--searches", "-1"], "--searches is -1, and has to be at least 0"),
        (["random-20-v1", "--processes", "0"], "--processes is 0, and has to be at least 1"),
        (["random-20-v1", "--seconds", "0"], "--seconds is 0, and has to be positive"),
    ],
)
def test_what_is_not_there_is_told_in_one_line(arguments, words, capsys):
    assert references.main(arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1


def test_known_routes_are_proven_where_prize_and_bound_are_equal():
    assert BestKnown(3.1, 3.1).proven
    assert not BestKnown(3.1, 3.2).proven
