"""The commands of the arena, end to end, and their statistics."""

import csv
import json
import math

import numpy as np
import pytest
from PIL import Image

from argo_env.envs.route_sources import TEST
from baselines import evaluate, plots
from baselines.comparison import compare
from baselines.episodes import EpisodeOutcome
from baselines.families import TEST_SETS
from baselines.intervals import Bootstrap
from baselines.references import BestKnown

FAST = ["given-order", "insertion"]


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The folder that a comparison of two policies on two instances wrote."""
    folder = tmp_path_factory.mktemp("arena") / "new"
    arguments = ["--instances", "2", "--out", str(folder), "--policy", *FAST]
    assert evaluate.main([*arguments, "--family", "random-20-v1", "noisy-20-v1"]) == 0
    return folder


def test_the_table_is_printed(capsys):
    assert evaluate.main(["--instances", "2", "--policy", *FAST]) == 0
    printed = capsys.readouterr().out
    words = "random-20-v1: 2 instances, the best known route proven to be the best for 2"
    for said in (words, "gap vs best", "s/instance", *FAST):
        assert said in printed
    assert "above the best known" not in printed  # nothing is open
    assert printed.index("insertion") < printed.index("given-order")  # the best comes first


def test_results_are_written(results):
    first, second = json.loads((results / "results.json").read_text())
    assert (first["test_set"], second["test_set"]) == ("random-20-v1", "noisy-20-v1")
    tables = (results / "results.md").read_text()
    assert tables.count("| insertion | ") == tables.count("| given-order | ") == 2
    with (results / "results.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) == 2 * 2 * 2
    for comparison in (first, second):
        best = sum(reference["prize"] for reference in comparison["best"])
        for row in comparison["rows"]:
            prizes = [
                float(line["prize"])
                for line in lines
                if (line["test_set"], line["policy"]) == (comparison["test_set"], row["policy"])
            ]
            assert row["prize"]["value"] == pytest.approx(np.mean(prizes))
            assert row["gap"]["value"] == pytest.approx(1 - sum(prizes) / best)
            assert row["prize"]["low"] <= row["prize"]["value"] <= row["prize"]["high"]
            assert row["feasible"]["value"] == 1.0


def test_equal_arguments_give_equal_results(results, tmp_path):
    arguments = ["--instances", "2", "--out", str(tmp_path), "--policy", *FAST]
    evaluate.main([*arguments, "--family", "random-20-v1", "noisy-20-v1"])

    def without_times(folder):
        data = json.loads((folder / "results.json").read_text())
        for comparison in data:
            for row in comparison["rows"]:
                del row["seconds"]
            for outcomes in comparison["outcomes"].values():
                for outcome in outcomes:
                    del outcome["seconds"]
        return data

    assert without_times(tmp_path) == without_times(results)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--family", "random-21"], "no test set `random-21`; there are: random-20-v1"),
        (["--policy", "best"], "no policy `best`"),
        (["--instances", "101"], "--instances is 101, and has to be 1 to 100"),
        (["--instances", "0"], "--instances is 0"),
        (["--seed", "-1"], "--seed is -1"),
    ],
)
def test_what_is_not_there_is_told_in_one_line(arguments, words, capsys):
    assert evaluate.main([*arguments, "--policy", *FAST] if "--policy" not in arguments
                         else arguments) == 2  # fmt: skip
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1


def compared(prizes_and_seconds, best):
    """Policies by name, with the prize on each instance and the seconds that each takes."""
    outcomes = {
        name: tuple(
            EpisodeOutcome(number, prize, 100.0, True, 3, seconds, (1, 0))
            for number, prize in zip(TEST, prizes, strict=False)
        )
        for name, (prizes, seconds) in prizes_and_seconds.items()
    }
    return compare(TEST_SETS["random-20-v1"], outcomes, best, 0)


KNOWN = (BestKnown(4.0, 5.0), BestKnown(6.0, 6.0))


def test_the_front_has_who_is_not_beaten_in_less_time():
    policies = {
        "slow": ([4.0, 6.0], 2.0),
        "slower": ([4.0, 6.0], 3.0),
        "rule": ([2.0, 2.0], 0.01),
        "rule as good": ([2.0, 2.0], 0.02),
        "bad": ([1.0, 1.0], 0.1),
        "quick": ([3.0, 5.0], 0.1),
    }
    comparison = compared(policies, KNOWN)
    assert [row.policy for row in comparison.front] == ["rule", "quick", "slow"]
    stars = {line[1]: line[0] for line in evaluate.lines(comparison)}
    assert {name for name, star in stars.items() if star == "*"} == {"rule", "quick", "slow"}


def test_what_is_not_proven_is_said():
    comparison = compared({"mine": ([4.0, 6.0], 1.0)}, KNOWN)
    assert (comparison.proven, comparison.open) == (1, pytest.approx(0.1))
    said = evaluate.title(comparison)
    assert "proven to be the best for 1; no routes win more than 10.0 % above" in said
    assert not evaluate.warnings(comparison)


def test_a_policy_that_beats_the_best_known_is_told(monkeypatch, capsys):
    comparison = compared({"mine": ([4.5, 6.0], 1.0), "other": ([4.0, 5.0], 1.0)}, KNOWN)
    (warning,) = evaluate.warnings(comparison)
    assert "mine BEATS the best known routes of random-20-v1 on 1 of 2 instances" in warning
    assert "first 1000000: 4.50, known 4.00" in warning
    assert "mine BEATS" in evaluate.markdown(comparison)
    # Insertion is better than a route of 1.
    stale = tuple(BestKnown(1.0, 99.0) for _ in range(100))
    monkeypatch.setattr(evaluate, "references", lambda _: stale)
    assert evaluate.main(["--instances", "2", "--policy", "insertion"]) == 0
    assert "WARNING: insertion BEATS" in capsys.readouterr().err


def test_results_are_read_as_they_were(tmp_path):
    comparison = compared({"mine": ([4.0, 6.0], 1.0)}, KNOWN)
    evaluate.write([comparison], tmp_path)
    assert plots.read_comparisons(tmp_path / "results.json") == [comparison]


def test_intervals_are_those_of_the_mean():
    values = np.random.default_rng(0).normal(5.0, 2.0, 400)
    interval = Bootstrap(400).mean(values)
    assert interval.value == pytest.approx(values.mean())
    # As wide as the normal distribution says.
    half = 1.96 * values.std() / math.sqrt(400)
    assert interval.high - interval.value == pytest.approx(half, rel=0.1)
    assert interval.value - interval.low == pytest.approx(half, rel=0.1)


def test_intervals_of_differences_are_paired():
    values = np.random.default_rng(0).normal(5.0, 2.0, 100)
    bootstrap = Bootstrap(100)
    apart = bootstrap.mean(values + 0.5).value - bootstrap.mean(values).value
    difference = bootstrap.mean((values + 0.5) - values)
    assert difference.low == pytest.approx(difference.high) == pytest.approx(apart)
    assert bootstrap.ratio(0.1 * values, values).low == pytest.approx(0.1)
    assert bootstrap.ratio(np.zeros(100), np.zeros(100)).value == 0.0


def picture(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def test_plots_are_drawn(results, tmp_path, capsys):
    out = ["--out", str(tmp_path)]
    for kind in ("gaps", "ranking"):
        assert plots.main([kind, str(results / "results.json"), *out]) == 0
    assert plots.main(["tour", "--policy", "insertion", *out]) == 0
    assert plots.main(["convergence", "--time-limit", "5", *out]) == 0
    drawn = capsys.readouterr().out.split()
    assert len(drawn) == 6
    for path in drawn:
        assert picture(path).std() > 5.0


def test_a_file_is_no_folder_for_results(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    arguments = ["--policy", "given-order", "--instances", "1", "--out", str(tmp_path / "file")]
    assert evaluate.main(arguments) == 2
    assert "can't be made a folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["gaps", "nowhere.json"], "nowhere.json can't be read"),
        (["ranking", "nowhere.json"], "nowhere.json can't be read"),
        (["tour", "--instance", "7"], "1000000 to 1000099, not 7"),
        (["tour", "--policy", "best"], "no policy `best`"),
    ],
)
def test_what_can_not_be_drawn_is_told_in_one_line(arguments, words, capsys):
    assert plots.main(arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
