"""Tests of the benchmark of published route problems, with small problems of their own."""

import dataclasses
import sys

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    RouteProblem,
    Tour,
    Visit,
    evaluate,
)
from benchmarks import peer_lkh, peer_pyvrp
from benchmarks.instances import Kind
from benchmarks.known_values import KnownValue, find_known_value
from benchmarks.routes import find_files, main
from benchmarks.routes_table import PeerResult, Row, row_line, summary_lines

ATSP = """NAME: three
TYPE: ATSP
DIMENSION: 3
EDGE_WEIGHT_TYPE: EXPLICIT
EDGE_WEIGHT_FORMAT: FULL_MATRIX
EDGE_WEIGHT_SECTION
0 1 9  9 0 2  4 9 0
EOF
"""
WINDOWS = "3\n0 5 5\n5 0 5\n5 5 0\n0 90\n20 30\n0 19\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "three.atsp").write_text(ATSP)
    (tmp_path / "late").mkdir()
    (tmp_path / "late" / "late.tw").write_text(WINDOWS)
    (tmp_path / "late" / "best_known.txt").write_text("# Instance Cost\nlate.tw 15 0\n# x :\n")
    return tmp_path


def test_the_table_of_two_problems(folder, capsys):
    pytest.importorskip("pyvrp")
    assert main([str(folder), "--time-limit", "1", "--workers", "1"]) == 0
    settings, _, header, _, three, late, _, *totals = capsys.readouterr().out.splitlines()
    assert settings.startswith("1 s for each problem, 1 workers")
    assert header == "|  | nodes | known | ours | off | bound | proven | time | by | PyVRP |"
    assert three.startswith("| ATSP three | 3 | - | 7 | 0 | 7 | yes | ")
    assert three.endswith(" | 7, 0 |")
    assert late.startswith("| TSPTW late | 3 | 15? | 15 | 0 | 15 | yes | ")
    assert late.endswith(" | 15, 0 |")
    for kind, one in zip(("ATSP", "TSPTW"), totals, strict=True):
        assert one.startswith(
            f"- {kind}: 1 problems, 1 proven (1 of 1 with up to 100 nodes), best known value or "
            "better 1 times, "
        )
        assert one.endswith(" s in all; PyVRP best known value 1 times of 1")


def test_files_are_picked_by_name(folder, capsys):
    assert [path.name for path in find_files(folder, "t*")] == ["three.atsp"]
    assert [path.name for path in find_files(folder, "*.tw")] == ["late.tw"]
    assert main([str(folder), "--only", "none"]) == 2
    assert "no file in it matches `none`" in capsys.readouterr().err
    assert main([str(folder / "none")]) == 2
    assert "is not a folder" in capsys.readouterr().err


def test_the_known_score_is_read_from_the_file_beside_the_problem(tmp_path):
    path = tmp_path / "some.oplib"
    assert find_known_value(path, Kind.OP) is None
    path.with_suffix(".sol").write_text(
        "ROUTE_NODES : 1\nROUTE_SCORE : 7\nROUTE_COST : 0\nNODE_SEQUENCE_SECTION\n1\n-1\n"
    )
    assert find_known_value(path, Kind.OP) == KnownValue(7)


def test_known_costs_of_tours_with_time_windows_are_read_from_the_files_beside_them(tmp_path):
    path = tmp_path / "some.tw"
    assert find_known_value(path, Kind.TSPTW) is None
    (tmp_path / "best_known.txt").write_text("other.tw 3 0\nsome.tw 628.62 0 # from there\n")
    assert find_known_value(path, Kind.TSPTW) == KnownValue(628.62, None, pytest.approx(0.005))
    (tmp_path / "bounds.txt").write_text("# of a table\nsome.tw 628.62 # optimal\n")
    assert find_known_value(path, Kind.TSPTW).proven


def test_losses_are_relative_to_the_best_value():
    def row(kind, value, peer, known):
        peers = (PeerResult("P", peer), PeerResult("L", None, "precedence"))
        return Row("x", kind, 5, known, value, 1.0, False, 1.0, "y", peers, None)

    cost, score = row(Kind.ATSP, 12.0, 8.0, KnownValue(10)), row(Kind.OP, 8.0, None, KnownValue(10))
    assert (cost.relative_loss_to_best(12.0), cost.relative_loss_to_best(8.0)) == (0.5, 0.0)
    assert (score.relative_loss_to_best(8.0), score.relative_loss_to_best(None)) == (
        pytest.approx(0.2),
        None,
    )
    rounded = row(Kind.TSPTW, 9.9967, 10.0041, KnownValue(10.0, 10.0, 0.005))
    assert (rounded.relative_loss_to_best(9.9967), rounded.relative_loss_to_best(10.0)) == (
        0.0,
        0.0,
    )
    lines = list(summary_lines([cost, score]))
    assert "P best known value 1 times of 1; L left out: precedence" in lines[0]
    assert len(lines) == 2
    text = row_line(dataclasses.replace(cost, wrong="it says more"))
    assert text == (
        "| ATSP x | 5 | 10? | 12 | 50.00 % | 1 | no | 1.0 s | y WRONG: it says more | 8, 0 |  |"
    )


LKH = """#!{python}
import sys
options = dict(line.split(" = ") for line in open(sys.argv[1]).read().splitlines() if " = " in line)
problem = open(options["PROBLEM_FILE"]).read()
open({copy!r}, "w").write(problem)
tour = "\\n".join(map(str, {nodes}))
open(options["TOUR_FILE"], "w").write("TYPE : TOUR\\nTOUR_SECTION\\n" + tour + "\\n-1\\nEOF\\n")
"""


def test_problems_are_passed_to_lkh(tmp_path):
    program, copy = tmp_path / "LKH", tmp_path / "copy"

    def program_with_tour(nodes):
        program.write_text(LKH.format(python=sys.executable, copy=str(copy), nodes=nodes))
        program.chmod(0o755)
        return program

    travel = np.array([[0, 4, 3, 9], [4, 0, NEVER, 2], [1, 5, 0, 8], [5, 2, 7, 0]])
    visits = (Visit("a", service=10), Visit("b"), Visit("c"))
    ordered = RouteProblem(visits, travel, precedences=(Precedence((2, 1), "c before b"),))
    route = peer_lkh.search_with_lkh(program_with_tour([1, 4, 2, 3, 5]), ordered, 0.1, 1)
    assert route == Tour((2, 0, 1))
    lines = copy.read_text().splitlines()
    assert "TYPE: SOP" in lines
    assert lines[-7:-1] == [
        "5",
        "0 5 2 7 100000000",
        "-1 0 14 13 19",
        "-1 4 0 -1 2",
        "-1 1 5 0 8",
        "-1 -1 -1 -1 0",
    ]
    assert peer_lkh.search_with_lkh(program_with_tour([1, 3, 4, 2, 5]), ordered, 0.1, 1) is None
    travel = np.where(travel == NEVER, 6, travel)
    late = tuple(dataclasses.replace(visit, latest=20 + 10 * k) for k, visit in enumerate(visits))
    timed = RouteProblem(late, travel, max_duration=90, objective=Objective.TRAVEL)
    assert peer_lkh.search_with_lkh(program_with_tour([4, 3, 1, 2]), timed, 0.1, 1) == Tour(
        (0, 2, 1)
    )
    assert copy.read_text().splitlines()[-8:-4] == ["1 0 90", "2 0 20", "3 0 30", "4 0 40"]
    tour = RouteProblem(visits, travel)
    assert peer_lkh.search_with_lkh(program_with_tour([2, 3, 4, 1]), tour, 0.1, 1) == Tour(
        (0, 1, 2)
    )
    assert "TYPE: ATSP" in copy.read_text()
    for problem, reason in [
        (RouteProblem(visits[:2], travel[:3, :3]), "fewer than three visits"),
        (
            RouteProblem((*visits[:2], Visit("c", mandatory=False, prize=1)), travel),
            "optional visits",
        ),
        (RouteProblem(visits, travel, battery=EnergyBudget(travel, 100)), "a battery"),
        (RouteProblem(visits, travel, max_duration=90), "without windows"),
        (RouteProblem(late, travel), "waiting"),
        (dataclasses.replace(timed, precedences=ordered.precedences), "precedence with windows"),
    ]:
        assert reason in peer_lkh.unsupported_feature(problem)
    with pytest.raises(ArgoError, match="does not support a maximum duration"):
        peer_lkh.search_with_lkh(program, RouteProblem(visits, travel, max_duration=90), 0.1, 1)
    with pytest.raises(ArgoError, match="can't be run as LKH"):
        peer_lkh.search_with_lkh(tmp_path / "none", tour, 0.1, 1)


def test_problems_are_passed_to_pyvrp():
    pytest.importorskip("pyvrp")
    travel = np.array([[0, 4, 3, 9], [4, 0, 6, 2], [1, 5, 0, 8], [5, 2, 7, 0]])
    visits = (
        Visit("a", service=10, mandatory=False, prize=3),
        Visit("b", service=1, mandatory=False, prize=5, earliest=9, latest=20),
        Visit("c", service=2),
    )
    for limit, order in [(60, {0, 1, 2}), (30, {1, 2})]:
        problem = RouteProblem(visits, travel, max_duration=limit)
        route = peer_pyvrp.search_with_pyvrp(problem, 0.1, 1)
        assert evaluate(problem, route).feasible
        assert set(route.order) == order
    assert (
        peer_pyvrp.search_with_pyvrp(RouteProblem(visits, travel, max_duration=3), 0.1, 1) is None
    )
    ordered = RouteProblem(visits, travel, precedences=(Precedence((0, 1), "a before b"),))
    assert peer_pyvrp.unsupported_feature(ordered) == "precedence"
    with pytest.raises(ArgoError, match="does not support precedence"):
        peer_pyvrp.search_with_pyvrp(ordered, 0.1, 1)
    powered = RouteProblem(visits, travel, battery=EnergyBudget(travel, 100))
    assert peer_pyvrp.unsupported_feature(powered) == "a battery"
    empty = RouteProblem((), travel[3:, 3:])
    assert peer_pyvrp.search_with_pyvrp(empty, 0.1, 1) == Tour(())
