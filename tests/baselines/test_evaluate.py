"""The commands that compare and plot policies, end to end, and their statistics."""

import csv
import json
import math
import os
import signal

import numpy as np
import pytest
from PIL import Image

from argo_env.envs.route_sources import TEST
from baselines import evaluate, plots
from baselines.comparison import compare_policies
from baselines.episodes import EpisodeOutcome
from baselines.families import TEST_SETS
from baselines.intervals import Bootstrap
from baselines.references import BestKnown

FAST = ["given-order", "insertion"]


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Compare two policies on two instances of two test sets, and return the folder."""
    folder = tmp_path_factory.mktemp("arena") / "new"
    arguments = ["--instances", "2", "--out", str(folder), "--policy", *FAST]
    assert evaluate.main([*arguments, "--family", "random-20-v1", "noisy-20-v1"]) == 0
    return folder


def test_the_table_is_printed(capsys):
    assert evaluate.main(["--instances", "2", "--policy", *FAST]) == 0
    printed = capsys.readouterr().out
    title = "random-20-v1: 2 instances, the best known route is proven optimal for 2"
    for text in (title, "gap vs best", "s/instance", *FAST):
        assert text in printed
    assert "above the best known" not in printed  # all are proven
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
        (["--family", "random-21"], "no test set `random-21`; choose one of: random-20-v1"),
        (["--policy", "best"], "no policy `best`"),
        (["--instances", "101"], "--instances is 101: give a number of instances from 1 to 100"),
        (["--instances", "0"], "--instances is 0"),
        (["--seed", "-1"], "--seed is -1"),
    ],
)
def test_a_wrong_argument_is_reported_in_one_line(arguments, words, capsys):
    assert evaluate.main([*arguments, "--policy", *FAST] if "--policy" not in arguments
                         else arguments) == 2  # fmt: skip
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def comparison_of(prizes_and_seconds, best):
    """Compare policies, given by name with the prize on each instance and the processor time."""
    outcomes = {
        name: tuple(
            EpisodeOutcome(number, prize, 100.0, True, 3, seconds, (1, 0))
            for number, prize in zip(TEST, prizes, strict=False)
        )
        for name, (prizes, seconds) in prizes_and_seconds.items()
    }
    return compare_policies(TEST_SETS["random-20-v1"], outcomes, best, 0)


KNOWN = (BestKnown(4.0, 5.0), BestKnown(6.0, 6.0))


class Interrupted:
    """Policy during whose construction a person presses Ctrl-C."""

    def __init__(self) -> None:
        os.kill(os.getpid(), signal.SIGINT)


def test_ctrl_c_ends_with_one_line(capsys):
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # may be ignored
    try:
        assert evaluate.main(["--policy", f"{__name__}:Interrupted"]) == 130
    finally:
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err == "interrupted\n"


def test_the_pareto_front_has_the_policies_that_no_faster_one_equals():
    policies = {
        "slow": ([4.0, 6.0], 2.0),
        "slower": ([4.0, 6.0], 3.0),
        "rule": ([2.0, 2.0], 0.01),
        "rule as good": ([2.0, 2.0], 0.02),
        "bad": ([1.0, 1.0], 0.1),
        "quick": ([3.0, 5.0], 0.1),
    }
    comparison = comparison_of(policies, KNOWN)
    assert [row.policy for row in comparison.pareto_front] == ["rule", "quick", "slow"]
    stars = {row[1]: row[0] for row in evaluate.table_rows(comparison)}
    assert {name for name, star in stars.items() if star == "*"} == {"rule", "quick", "slow"}


def test_the_title_states_missing_proofs():
    comparison = comparison_of({"mine": ([4.0, 6.0], 1.0)}, KNOWN)
    assert (comparison.proven, comparison.open) == (1, pytest.approx(0.1))
    title = evaluate.comparison_title(comparison)
    assert "is proven optimal for 1; no routes win more than 10.0 % above" in title
    assert not evaluate.beaten_reference_warnings(comparison)


def test_a_policy_that_beats_the_best_known_is_reported(monkeypatch, capsys):
    comparison = comparison_of({"mine": ([4.5, 6.0], 1.0), "other": ([4.0, 5.0], 1.0)}, KNOWN)
    (warning,) = evaluate.beaten_reference_warnings(comparison)
    assert "mine BEATS the best known routes of random-20-v1 on 1 of 2 instances" in warning
    assert "first 1000000: 4.50, known 4.00" in warning
    assert "mine BEATS" in evaluate.to_markdown(comparison)
    # Insertion wins more than a prize of 1.
    stale = tuple(BestKnown(1.0, 99.0) for _ in range(100))
    monkeypatch.setattr(evaluate, "load_references", lambda _: stale)
    assert evaluate.main(["--instances", "2", "--policy", "insertion"]) == 0
    assert "WARNING: insertion BEATS" in capsys.readouterr().err


def test_results_are_read_as_they_were_written(tmp_path):
    comparison = comparison_of({"mine": ([4.0, 6.0], 1.0)}, KNOWN)
    evaluate.write_results([comparison], tmp_path)
    assert plots.read_comparisons(tmp_path / "results.json") == [comparison]


def test_intervals_are_those_of_the_mean():
    values = np.random.default_rng(0).normal(5.0, 2.0, 400)
    interval = Bootstrap(400).mean(values)
    assert interval.value == pytest.approx(values.mean())
    # The width is that of the normal approximation.
    half = 1.96 * values.std() / math.sqrt(400)
    assert interval.high - interval.value == pytest.approx(half, rel=0.1)
    assert interval.value - interval.low == pytest.approx(half, rel=0.1)


def test_intervals_of_differences_are_paired():
    values = np.random.default_rng(0).normal(5.0, 2.0, 100)
    bootstrap = Bootstrap(100)
    unpaired = bootstrap.mean(values + 0.5).value - bootstrap.mean(values).value
    difference = bootstrap.mean((values + 0.5) - values)
    assert difference.low == pytest.approx(difference.high) == pytest.approx(unpaired)
    assert bootstrap.ratio_of_sums(0.1 * values, values).low == pytest.approx(0.1)
    assert bootstrap.ratio_of_sums(np.zeros(100), np.zeros(100)).value == 0.0


def read_picture(path):
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
        assert read_picture(path).std() > 5.0


def test_a_file_in_place_of_the_results_folder_is_an_error(tmp_path, capsys):
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
def test_an_impossible_plot_is_reported_in_one_line(arguments, words, capsys):
    assert plots.main(arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
