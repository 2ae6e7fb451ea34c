"""References, the best known routes of the test sets: they never get worse."""

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
from baselines.problem import hindsight_problem
from baselines.references import BestKnown, Effort, improve_best_known, update_references

NUMBER = 1_000_003
QUICK = Effort(2.0, searches=1)


def instances_of(name, family, count=1):
    return InstanceSet(name, family, range(NUMBER, NUMBER + count))


SMALL = instances_of("small", InstanceFamily(8, budget=600.0))
NOISY = instances_of(
    "noisy", InstanceFamily(8, budget=600.0, noise=RouteNoise(failing=0.4, blocked=2))
)


def problem_for(test_set, number=NUMBER):
    return hindsight_problem(test_set.family.source.draw(number)).problem


def fake_optimiser(monkeypatch, order, prize, bound):
    """Replace the optimiser by one that always returns this route and bound."""
    suggestion = RouteSuggestion(Tour(order), prize, bound, 0, 0, prize == bound)
    monkeypatch.setattr(references, "suggest_route", lambda *_, **__: suggestion)


@pytest.mark.parametrize("name", TEST_SETS)
def test_known_routes_win_the_stored_prize(name):
    """A tenth of the instances is evaluated by the definition of a route's cost."""
    test_set = TEST_SETS[name]
    known = references.load_references(name)
    for number, best in list(zip(test_set.numbers, known, strict=True))[::10]:
        if best.route:
            problem = problem_for(test_set, number)
            value = evaluate(problem, Tour(tuple(node - 1 for node in best.route)))
            assert value.feasible
            assert value.prize / 100 == pytest.approx(best.prize)
            assert value.duration * problem.unit == best.time
        assert best.proven == (best.prize == best.bound)


@pytest.mark.parametrize("test_set", [SMALL, NOISY], ids=["small", "noisy"])
def test_a_new_reference_is_a_route_with_its_proof(test_set):
    best = improve_best_known(test_set, NUMBER, None, QUICK)
    assert best.proven
    value = evaluate(problem_for(test_set), Tour(tuple(node - 1 for node in best.route)))
    assert value.feasible
    assert value.prize / 100 == pytest.approx(best.prize)


def test_the_best_of_all_routes_is_stored(monkeypatch):
    best = improve_best_known(SMALL, NUMBER, None, QUICK)
    bound = round(100 * best.prize)
    # The search finds no route, so the best one is the known one, a given one or a policy's.
    fake_optimiser(monkeypatch, (), 0, bound)
    monkeypatch.setattr(references, "insert_and_improve", lambda _: ())
    assert improve_best_known(SMALL, NUMBER, replace(best, bound=9.9), QUICK) == best
    assert improve_best_known(SMALL, NUMBER, None, QUICK, [best.route, (1,)]) == best
    without_route = improve_best_known(SMALL, NUMBER, None, QUICK)
    assert without_route.prize == 0.0
    assert not without_route.proven
    (outcome,) = play(make_policy("nearest-neighbour"), SMALL, 1)
    effort = Effort(1.0, 1, ("nearest-neighbour",))
    with_policy = improve_best_known(SMALL, NUMBER, without_route, effort)
    assert with_policy.prize == pytest.approx(outcome.prize)
    assert with_policy.route == outcome.route[:-1]


def test_infeasible_routes_are_ignored(monkeypatch):
    best = improve_best_known(SMALL, NUMBER, None, QUICK)
    fake_optimiser(monkeypatch, (), 0, round(100 * best.prize))
    every = tuple(range(1, 9))
    assert not evaluate(problem_for(SMALL), Tour(tuple(n - 1 for n in every))).feasible
    assert improve_best_known(SMALL, NUMBER, best, QUICK, [every, (1, 1)]) == best


def test_of_equal_prizes_the_shorter_route_is_stored():
    best = improve_best_known(SMALL, NUMBER, None, QUICK)
    longer = replace(best, time=best.time + 1.0)
    assert improve_best_known(SMALL, NUMBER, longer, QUICK, [best.route]) == best


def test_an_instance_with_a_proof_is_not_searched_again(monkeypatch):
    best = improve_best_known(SMALL, NUMBER, None, QUICK)
    monkeypatch.setattr(references, "suggest_route", None)
    assert improve_best_known(SMALL, NUMBER, best, QUICK) == best


def test_a_bound_that_a_route_exceeds_is_an_error(monkeypatch):
    best = improve_best_known(SMALL, NUMBER, None, QUICK)
    fake_optimiser(monkeypatch, (), 0, 10)
    with pytest.raises(ArgoError, match=r"more than the upper bound 0\.1: the optimiser is"):
        improve_best_known(SMALL, NUMBER, replace(best, bound=9.9), QUICK)


def test_a_file_of_references_never_gets_worse(tmp_path):
    test_set, file = instances_of("two", InstanceFamily(6, budget=500.0), 2), tmp_path / "two.json"
    update_references(test_set, file, QUICK)
    first = json.loads(file.read_text())
    assert first["checksum"] == test_set.checksum()
    assert len(first["instances"]) == 2
    update_references(test_set, file, QUICK, processes=2)
    assert json.loads(file.read_text()) == first
    # References of other instances are discarded.
    foreign = first | {"checksum": "other"}
    foreign["instances"] = [one | {"prize": 99.0, "bound": 99.0} for one in first["instances"]]
    file.write_text(json.dumps(foreign))
    update_references(test_set, file, QUICK)
    assert json.loads(file.read_text()) == first


def test_routes_of_results_are_read_by_instance(tmp_path):
    route = [3, 1, 3, 2, 0]  # the first reading of checkpoint 3 failed
    outcomes = {"mine": [{"instance": 7, "route": route}], "other": [{"instance": 7, "route": [0]}]}
    results = [{"test_set": "a", "outcomes": outcomes}, {"test_set": "b", "outcomes": {}}]
    (tmp_path / "results.json").write_text(json.dumps(results))
    assert references.read_routes([tmp_path / "results.json"], "a") == {7: [(1, 3, 2), ()]}
    assert references.read_routes([tmp_path / "results.json"], "b") == {}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["random-21"], "no test set `random-21`"),
        (["random-20-v1", "--results", "nowhere.json"], "nowhere.json can't be read"),
        (["random-20-v1", "--searches", "-1"], "--searches is -1: give a number of at least 0"),
        (["random-20-v1", "--processes", "0"], "--processes is 0: give a number of at least 1"),
        (["random-20-v1", "--seconds", "0"], "--seconds is 0: give a positive number"),
    ],
)
def test_a_wrong_argument_is_reported_in_one_line(arguments, words, capsys):
    assert references.main(arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def test_known_routes_are_proven_where_prize_and_bound_are_equal():
    assert BestKnown(3.1, 3.1).proven
    assert not BestKnown(3.1, 3.2).proven
