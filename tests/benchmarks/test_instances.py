"""Tests of the reader of published route problems, and of its messages."""

import itertools
import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import NEVER, Objective, Tour, evaluate
from argo_compiler.route.suggestion import suggest_route
from benchmarks.instances import MAX_NODES, Kind, read_known_route, read_published_problem
from tests.conftest import examples

DISTANCES = st.integers(2, 7).flatmap(
    lambda n: st.lists(
        st.lists(st.integers(0, 9999), min_size=n, max_size=n), min_size=n, max_size=n
    )
)


def read(folder, text, name="some.txt"):
    path = folder / name
    path.write_text(text)
    return read_published_problem(path)


def wrapped(numbers, width):
    """Return the numbers in lines of a width that need not be that of a row, as in TSPLIB."""
    rows = [numbers[k : k + width] for k in range(0, len(numbers), width)]
    return "\n".join("   ".join(map(str, row)) for row in rows)


def explicit(kind, rows, form="FULL_MATRIX", width=5, numbers=None, more=""):
    numbers = list(itertools.chain(*rows)) if numbers is None else numbers
    return (
        f"NAME:  x\nTYPE: {kind}\nCOMMENT: one\nCOMMENT: two\nDIMENSION : {len(rows)}\n"
        f"EDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: {form} \n{more}"
        f"EDGE_WEIGHT_SECTION\n{wrapped(numbers, width)}\nEOF\n"
    )


def length(rows, nodes):
    return sum(rows[a][b] for a, b in itertools.pairwise(nodes))


@settings(deadline=None, max_examples=examples(25))
@given(rows=DISTANCES, width=st.integers(1, 9), random=st.randoms(use_true_random=False))
def test_tours_cost_what_the_matrix_says(tmp_path_factory, rows, width, random):
    named = read(tmp_path_factory.mktemp("x"), explicit("ATSP", rows, width=width), "seven.atsp")
    assert (named.name, named.kind) == ("seven", Kind.ATSP)
    nodes = list(range(1, len(rows)))
    random.shuffle(nodes)
    evaluation = evaluate(named.problem, named.make_route([1, *(node + 1 for node in nodes)]))
    assert evaluation.feasible
    assert named.published_value(evaluation.prize, evaluation.duration) == length(
        rows, [0, *nodes, 0]
    )


@settings(deadline=None, max_examples=examples(25))
@given(rows=DISTANCES, form=st.sampled_from(["UPPER", "LOWER", "UPPER_DIAG", "LOWER_DIAG"]))
def test_triangles_are_symmetric(tmp_path_factory, rows, form):
    n = len(rows)
    diagonal = form.endswith("DIAG")
    inside = [
        (i, j)
        for i in range(n)
        for j in range(n)
        if (diagonal and i == j) or (i < j if "UPPER" in form else i > j)
    ]
    text = explicit("TSP", rows, f"{form}_ROW", numbers=[rows[i][j] for i, j in inside])
    travel = read(tmp_path_factory.mktemp("x"), text).problem.travel
    full = np.zeros((n, n), dtype=np.int64)
    for i, j in inside:
        if i != j:
            full[i, j] = full[j, i] = rows[i][j]
    last = [*range(1, n), 0]
    assert (travel == full[np.ix_(last, last)]).all()


@settings(deadline=None, max_examples=examples(25))
@given(
    rows=DISTANCES.filter(lambda rows: len(rows) > 3),
    again=st.booleans(),
    random=st.randoms(use_true_random=False),
)
def test_orders_of_a_sequential_ordering_problem(tmp_path_factory, rows, again, random):
    n = len(rows)
    rows = [[0 if i == j else d for j, d in enumerate(row)] for i, row in enumerate(rows)]
    free = [row.copy() for row in rows]
    hidden = list(range(1, n - 1))
    random.shuffle(hidden)
    before = {pair for pair in itertools.combinations(hidden, 2) if random.random() < 0.4}
    before |= {(0, node) for node in range(1, n)} | {(node, n - 1) for node in range(n - 1)}
    for a, b in before:
        rows[b][a] = -1
    numbers = ([n] if again else []) + list(itertools.chain(*rows))
    text = explicit("SOP", rows, numbers=numbers, width=n)
    named = read(tmp_path_factory.mktemp("x"), text)
    for middle in itertools.permutations(range(1, n - 1)):
        order = (0, *middle, n - 1)
        evaluation = evaluate(named.problem, named.make_route([node + 1 for node in order]))
        allowed = not any((b, a) in before for a, b in itertools.combinations(order, 2))
        assert evaluation.feasible == allowed
        if allowed:
            assert evaluation.duration == length(free, order)


def test_precedences_have_words_and_forbidden_pairs_no_travel_time(tmp_path):
    rows = [[0, 1, 2, 9], [-1, 0, 3, 4], [-1, -1, 0, 5], [-1, -1, -1, 0]]
    problem = read(tmp_path, explicit("SOP", rows)).problem
    assert [precedence.words for precedence in problem.precedences] == ["node 2 before node 3"]
    assert problem.travel.tolist() == [[0, 3, 4], [NEVER, 0, 5], [1, 2, 9]]


def orienteering(kind, points, scores, depot, limit):
    coordinates = "\n".join(f"{k} {x} {y}" for k, (x, y) in enumerate(points, start=1))
    worth = "\n".join(f"{k} {score}" for k, score in enumerate(scores, start=1))
    return (
        f"NAME : y\nCOMMENT : made\nTYPE : OP\nDIMENSION : {len(points)}\nCOST_LIMIT : {limit}\n"
        f"EDGE_WEIGHT_TYPE : {kind}\nNODE_COORD_SECTION\n{coordinates}\n"
        f"NODE_SCORE_SECTION\n{worth}\nDEPOT_SECTION\n{depot}\n-1\nEOF\n"
    )


ROUNDED = {
    "EUC_2D": lambda square: int(math.sqrt(square) + 0.5),
    "CEIL_2D": lambda square: math.ceil(math.sqrt(square)),
    "ATT": lambda square: math.ceil(math.sqrt(square / 10)),
}


@settings(deadline=None, max_examples=examples(40))
@given(
    kind=st.sampled_from([*ROUNDED]),
    points=st.lists(st.tuples(*[st.integers(0, 900)] * 2), min_size=2, max_size=8),
    limit=st.integers(0, 5000),
    data=st.data(),
)
def test_scores_within_a_limit(tmp_path_factory, kind, points, limit, data):
    n = len(points)
    scores = data.draw(st.lists(st.integers(0, 99), min_size=n, max_size=n))
    depot = data.draw(st.integers(1, n))
    made = data.draw(st.lists(st.sampled_from(range(1, n + 1)), unique=True))
    nodes = [depot, *(node for node in made if node != depot)]
    text = orienteering(kind, points, scores, depot, limit)
    named = read(tmp_path_factory.mktemp("x"), text)
    assert named.problem.objective == Objective.PRIZE
    evaluation = evaluate(named.problem, named.make_route(nodes))
    assert named.published_value(evaluation.prize, 0) == sum(scores[node - 1] for node in nodes)
    assert evaluation.duration == sum(
        ROUNDED[kind](sum((a - b) ** 2 for a, b in zip(points[i - 1], points[j - 1], strict=True)))
        for i, j in itertools.pairwise([*nodes, depot])
    )
    assert evaluation.feasible == (evaluation.duration <= limit)


def test_distances_on_earth_are_whole_kilometres(tmp_path):
    # Latitudes and longitudes in degrees.minutes: a degree and a half of a great circle, 166.98 km.
    text = orienteering("GEO", [(0.0, 0.0), (0.0, 1.30), (-1.30, 0.0)], [0, 1, 1], 1, 999)
    travel = read(tmp_path, text).problem.travel
    assert travel[2].tolist() == [167, 167, 0]
    assert travel[0, 1] == 237


def test_known_routes(tmp_path):
    (tmp_path / "y.sol").write_text(
        "NAME : y\nTYPE : OP\nROUTE_NODES : 3\nROUTE_SCORE : 7\nROUTE_COST : 12\n"
        "NODE_SEQUENCE_SECTION\n2\n1\n3\n-1\nDEPOT_SECTION\n2\n-1\nEOF\n"
    )
    known = read_known_route(tmp_path / "y.sol")
    assert (known.nodes, known.score, known.cost) == ((2, 1, 3), 7, 12)


def time_windows(rows, windows):
    lines = [str(len(rows)), *(" ".join(map(str, row)) for row in rows)]
    lines += [f"{opens}   {closes}   " for opens, closes in windows]
    return "\n".join([*lines, "# Sum of service times: 0"]) + "\n"


@settings(deadline=None, max_examples=examples(40))
@given(rows=DISTANCES, decimals=st.integers(0, 2), data=st.data())
def test_tours_with_time_windows(tmp_path_factory, rows, decimals, data):
    n, scale = len(rows), 10**decimals
    opening = data.draw(st.lists(st.integers(0, 9999), min_size=n, max_size=n))
    windows = [(opens, opens + data.draw(st.integers(0, 9999))) for opens in opening]
    text = time_windows(
        [[f"{d / scale:.{decimals}f}" for d in row] for row in rows],
        [(opens / scale, closes / scale) for opens, closes in windows],
    )
    named = read(tmp_path_factory.mktemp("x"), text, "z.tw")
    nodes = data.draw(st.permutations(range(1, n)))
    evaluation = evaluate(named.problem, named.make_route([node + 1 for node in nodes]))
    time, late = windows[0][0], False
    for a, b in itertools.pairwise([0, *nodes, 0]):
        time = max(time + rows[a][b], windows[b][0])
        late |= time > windows[b][1]
    assert evaluation.feasible == (not late)
    travel = length(rows, [0, *nodes, 0])
    assert named.published_value(0, evaluation.cost(named.problem.objective)) == pytest.approx(
        travel / scale
    )


def customers(nodes):
    rows = [
        f"{k}\t{x} {y} 0  {opens} {closes} 0"
        for k, ((x, y), (opens, closes)) in enumerate(nodes, 1)
    ]
    return "\n".join(["!! some", "", "CUST NO.  XCOORD.", *rows, "999 0 0 0 0 0 0", ""])


def test_tours_between_coordinates_take_truncated_times_made_shorter(tmp_path):
    nodes = [((0, 0), (0, 99)), ((3, 3), (2, 30)), ((6, 6), (0, 40)), ((0, 7), (8, 9))]
    named = read(tmp_path, customers(nodes))
    assert (named.kind, named.nodes) == (Kind.TSPTW, (2, 3, 4))
    # Node 1 to node 2: 4.24 becomes 4. Node 1 to node 3: 8.49 becomes 8, as long as over node 2.
    evaluation = evaluate(named.problem, named.make_route([3, 2, 4]))
    assert evaluation.cost(Objective.TRAVEL) == 8 + 4 + 5 + 7
    assert not evaluation.feasible
    assert evaluate(named.problem, named.make_route([4, 3, 2])).feasible
    # 7.07 and 7.81 become 7; 14.87 becomes 14, the sum of both.
    bent = read(tmp_path, customers([((0, 0), (0, 99)), ((5, 5), (0, 99)), ((10, 11), (0, 99))]))
    assert bent.problem.travel.tolist() == [[0, 7, 7], [7, 0, 14], [7, 14, 0]]


SQUARE = [[0, 1], [1, 0]]
COORDINATES = orienteering("EUC_2D", [(0, 0), (1, 1)], [0, 5], 1, 10)
WINDOWS = time_windows(SQUARE, [(0, 9), (1, 5)])
CUSTOMERS = customers([((0, 0), (0, 9)), ((1, 1), (0, 5))])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("\n \n", "the file is empty"),
        ("# nothing but a comment\n", "the number of nodes"),
        ("\0" * 9, "binary"),
        ("Lorem ipsum, dolor\n", ":1: `Lorem ipsum, dolor` is not a keyword"),
        ("{}", ":1: `{}` is not a keyword"),
        (explicit("HCP", SQUARE), ":2: problems of TYPE `HCP` are not read; there are: TSP, "),
        (explicit("ATSP", SQUARE).replace("TYPE: ATSP\n", ""), "it has no TYPE"),
        (explicit("ATSP", SQUARE).replace(": 2", ": two"), ":5: DIMENSION `two` is not a whole"),
        (explicit("ATSP", SQUARE).replace(": 2", ": 0"), ":5: 0 nodes"),
        (explicit("ATSP", SQUARE).replace(": 2", f": {MAX_NODES + 1}"), f"at most {MAX_NODES}"),
        (explicit("ATSP", SQUARE).replace(": 2", ": 3"), ":9: of 9 numbers for EDGE_WEIGHT"),
        (explicit("ATSP", SQUARE).replace("EOF", "7\nEOF"), ":10: there are 1 numbers more"),
        (explicit("ATSP", [[0, "x"], [1, 0]]), ":9: `x` is not a number"),
        (explicit("ATSP", [[0, "nan"], [1, 0]]), ":9: `nan` is not a number"),
        (explicit("ATSP", [[0, "1e99"], [1, 0]]), ":9: `1e99` is not a number"),
        (explicit("ATSP", [[0, 1.5], [1, 0]]), ":9: 1.5 is not a distance"),
        (explicit("ATSP", [[0, -2], [1, 0]]), ":9: -2 is not a distance"),
        (explicit("ATSP", [[0, -1], [1, 0]]), "meant to be SOP"),
        (
            explicit("SOP", SQUARE).replace("0   1   1", "0   -1   1"),
            "before the first or after the last",
        ),
        (explicit("ATSP", SQUARE, "LOWER_COL"), "EDGE_WEIGHT_FORMAT LOWER_COL is not read"),
        (explicit("ATSP", SQUARE, more="TYPE: ATSP\n"), ":8: TYPE is given a second time"),
        (COORDINATES.replace("EUC_2D", "XRAY1"), "EDGE_WEIGHT_TYPE XRAY1 is not read"),
        (COORDINATES.replace("2 1 1", "1 1 1"), ":9: 1 is not a node, or is given twice,"),
        (COORDINATES.replace("2 5", "2 -5"), "the score of node 2 is -5"),
        (COORDINATES.replace("COST_LIMIT : 10", "COST_LIMIT : -1"), "-1 is negative"),
        (COORDINATES.replace("COST_LIMIT : 10\n", ""), "it has no COST_LIMIT"),
        (
            COORDINATES.replace("DEPOT_SECTION\n1", "DEPOT_SECTION\n3"),
            "3 is not a node; there are 1",
        ),
        (COORDINATES.split("NODE_SCORE")[0], "it has no NODE_SCORE_SECTION"),
        (WINDOWS.replace("1 0", "1 -4"), ":3: -4 is a negative time"),
        (WINDOWS.replace("1   5", "7   5"), ":5: 7 is part of a time window"),
        (WINDOWS.replace("1   5", "1"), "of 4 numbers for the time windows there are 3"),
        (WINDOWS.replace("1   5", "1   5.000001"), "more than 5 decimals"),
        (WINDOWS.replace("2\n", "2.5\n", 1), ":1: 2.5 nodes"),
        (WINDOWS.replace("2\n", "9999\n", 1), "at most"),
        (CUSTOMERS.replace("0 5 0", "6 5 0"), ":5: 6 is part of a time window"),
        (CUSTOMERS.replace("0 5 0", "0 5 3"), ":5: 3 is a service time"),
        (CUSTOMERS.replace("999 0", ""), ":6: of 7 numbers for a node there are 5"),
        (CUSTOMERS + "7\n", ":7: there are 1 numbers more"),
        (CUSTOMERS.partition("1\t")[0], ":3: 0 nodes"),
    ],
)
def test_wrong_files_are_refused_with_the_line(tmp_path, text, message):
    with pytest.raises(ArgoError) as error:
        read(tmp_path, text)
    assert str(tmp_path / "some.txt") in str(error.value)
    assert message in str(error.value)


def test_paths_without_a_text_file_are_refused(tmp_path):
    (tmp_path / "x.bin").write_bytes(b"\x00\x01\x02")
    for path, message in [
        (tmp_path, "is a directory"),
        (tmp_path / "none", "no such file"),
        (tmp_path / "x.bin", "is a binary file"),
        (Path("\0"), "can't be read"),
    ]:
        with pytest.raises(ArgoError, match=message):
            read_published_problem(path)


@settings(deadline=None, max_examples=examples(150))
@given(data=st.data())
def test_spoilt_files_are_read_or_refused(tmp_path_factory, data):
    whole = data.draw(
        st.sampled_from(
            [explicit("SOP", [[0, 1, 2], [-1, 0, 3], [-1, -1, 0]]), COORDINATES, WINDOWS, CUSTOMERS]
        )
    )
    begin, end = sorted(data.draw(st.tuples(*[st.integers(0, len(whole))] * 2)))
    text = whole[:begin] + data.draw(st.text("0123456789-.:eE \nEOFx_#", max_size=6)) + whole[end:]
    try:
        named = read(tmp_path_factory.mktemp("x"), text)
    except ArgoError:
        return
    evaluate(named.problem, Tour(tuple(range(named.problem.size))))


ORIGINALS = os.environ.get("ARGO_ROUTES")


@pytest.fixture
def originals():
    if not ORIGINALS:
        pytest.skip("ARGO_ROUTES names no folder: the published route problems are not read")
    return Path(ORIGINALS)


def test_published_routes_have_their_published_score_and_cost(originals):
    paths = sorted(originals.rglob("*.sol"))
    assert paths
    for path in paths:
        known = read_known_route(path)
        named = read_published_problem(path.with_suffix(".oplib"))
        evaluation = evaluate(named.problem, named.make_route(known.nodes))
        assert evaluation.feasible
        assert (named.published_value(evaluation.prize, 0), evaluation.duration) == (
            known.score,
            known.cost,
        )


def test_all_published_problems_are_read(originals):
    endings = {".atsp": Kind.ATSP, ".sop": Kind.SOP, ".oplib": Kind.OP, ".tw": Kind.TSPTW}
    paths = [path for path in originals.rglob("*") if path.suffix in endings]
    assert {path.suffix for path in paths} == {*endings}
    for path in paths:
        assert read_published_problem(path).kind == endings[path.suffix]


@pytest.mark.parametrize(
    ("file", "value"),
    [("atsp/br17.atsp", 39), ("sop/ESC12.sop", 1675), ("tsptw/rbg010a.tw", 671),
     ("tsptw/rbg017.tw", 893), ("tsptw/rbg019c.tw", 4536)],
)  # fmt: skip
def test_small_published_problems_are_solved_to_their_known_values(originals, file, value):
    named = read_published_problem(originals / file)
    suggestion = suggest_route(named.problem, 30.0)  # they take less than 1 s on a quiet machine
    assert suggestion.proven
    assert named.published_value(suggestion.prize, suggestion.cost) == named.published_value(
        suggestion.prize_bound, suggestion.bound
    )
    assert named.published_value(suggestion.prize, suggestion.cost) == value
