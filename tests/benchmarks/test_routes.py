"""The benchmark of published route problems, on small ones of its own."""

import json

import numpy as np
import pytest

from argo_compiler.errors import ArgoError
from argo_compiler.route import EnergyBudget, Precedence, RouteProblem, Tour, Visit, evaluate
from benchmarks import peer_pyvrp
from benchmarks.instances import Kind
from benchmarks.routes import Known, Row, find_files, known_of, main, summary

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
    into = folder / "rows.json"
    assert main([str(folder), "--time-limit", "0.3", "--workers", "1", "--json", str(into)]) == 0
    late, three = json.loads(into.read_text())["rows"]
    assert (late["value"], late["bound"], late["proven"], late["peer"]) == (15.0, 15.0, True, 15.0)
    assert late["known"] == {"value": 15.0, "bound": None}
    assert (three["value"], three["bound"], three["peer"]) == (7.0, 7.0, 7.0)
    assert three["known"] is None
    lines = capsys.readouterr().out.splitlines()
    assert "15?" in lines[2]
    assert lines[-2:] == [
        "ATSP: 1 problems, 1 proven, best known value or better 1 times, "
        f"{three['seconds']:.1f} s in all; PyVRP best known value 1 times of 1",
        "TSPTW: 1 problems, 1 proven, best known value or better 1 times, "
        f"{late['seconds']:.1f} s in all; PyVRP best known value 1 times of 1",
    ]


def test_files_are_picked_by_name(folder, capsys):
    assert [path.name for path in find_files(folder, "t*")] == ["three.atsp"]
    assert [path.name for path in find_files(folder, "*.tw")] == ["late.tw"]
    assert main([str(folder), "--only", "none"]) == 2
    assert "no file in it fits `none`" in capsys.readouterr().err
    assert main([str(folder / "none")]) == 2
    assert "is no folder" in capsys.readouterr().err


def test_what_is_known_of_a_score_is_beside_it(tmp_path):
    path = tmp_path / "some.oplib"
    assert known_of(path, Kind.OP) is None
    path.with_suffix(".sol").write_text(
        "ROUTE_NODES : 1\nROUTE_SCORE : 7\nROUTE_COST : 0\nNODE_SEQUENCE_SECTION\n1\n-1\n"
    )
    assert known_of(path, Kind.OP) == Known(7)


def test_values_are_off_by_a_share_of_the_best():
    def row(kind, value, peer):
        return Row("x", kind, 5, Known(10), value, 1.0, False, 1.0, "y", peer, None, None)

    cost, score = row(Kind.ATSP, 12.0, 8.0), row(Kind.OP, 8.0, None)
    assert (cost.off(cost.value), cost.off(cost.peer)) == (0.5, 0.0)
    assert (score.off(score.value), score.off(score.peer)) == (pytest.approx(0.2), None)
    assert len(list(summary([cost, score]))) == 2


def test_a_problem_as_pyvrp_sees_it():
    pytest.importorskip("pyvrp")
    travel = np.array([[0, 4, 3, 9], [4, 0, 6, 2], [1, 5, 0, 8], [5, 2, 7, 0]])
    visits = (
        Visit("a", service=10, mandatory=False, prize=3),
        Visit("b", service=1, mandatory=False, prize=5, earliest=9, latest=20),
        Visit("c", service=2),
    )
    for limit, order in [(60, {0, 1, 2}), (30, {1, 2})]:
        problem = RouteProblem(visits, travel, max_duration=limit)
        route = peer_pyvrp.search(problem, 0.1, 1)
        assert evaluate(problem, route).feasible
        assert set(route.order) == order
    assert peer_pyvrp.search(RouteProblem(visits, travel, max_duration=3), 0.1, 1) is None
    ordered = RouteProblem(visits, travel, precedences=(Precedence((0, 1), "a before b"),))
    assert peer_pyvrp.why_not(ordered) == "precedence"
    with pytest.raises(ArgoError, match="does not know precedence"):
        peer_pyvrp.search(ordered, 0.1, 1)
    powered = RouteProblem(visits, travel, battery=EnergyBudget(travel, 100))
    assert peer_pyvrp.why_not(powered) == "a battery"
    empty = RouteProblem((), travel[3:, 3:])
    assert peer_pyvrp.search(empty, 0.1, 1) == Tour(())
