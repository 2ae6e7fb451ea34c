"""Tests that route problems survive writing and reading, and that errors name their place."""

import json
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.files.route_problem_file import (
    parse_route_problem,
    read_route_problem,
    route_problem_text,
    route_suggestion_text,
    write_route_problem,
)
from argo_compiler.route import Round, RouteProblem, Visit, suggest_route
from tests.argo_compiler.route.random_problems import random_problem

PROBLEM = RouteProblem(
    (Visit("a", prize=2), Visit("b", mandatory=False)),
    np.arange(9).reshape(3, 3),
    rounds=(Round("both", (0, 1), 2),),
    words={"max_duration": "the shift"},
)
TEXT = route_problem_text(PROBLEM)


def assert_equal(one: object, other: object) -> None:
    for field in fields(one):  # type: ignore[arg-type]
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            assert a.dtype == b.dtype
            assert np.array_equal(a, b), field.name
        elif field.name == "battery" and is_dataclass(a):
            assert_equal(a, b)
        else:
            assert a == b, field.name


@given(st.integers(0, 10_000))
def test_reading_returns_the_written_problem(seed: int) -> None:
    problem = random_problem(np.random.default_rng(seed), 6)
    assert_equal(problem, parse_route_problem(route_problem_text(problem), "problem"))


def test_files(tmp_path: Path) -> None:
    path = tmp_path / "problem.json"
    write_route_problem(PROBLEM, path)
    assert_equal(PROBLEM, read_route_problem(path))
    with pytest.raises(ArgoError, match="does not exist"):
        read_route_problem(tmp_path / "none.json")
    with pytest.raises(ArgoError, match=r"x\.json can't be written"):
        write_route_problem(PROBLEM, tmp_path / "none" / "x.json")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", r"^p:1:2: the text is not JSON"),
        ("[" * 100_000, "^p: the text is not JSON: it is nested too deeply"),
        ("[]", "not a route problem of version 1"),
        ('{"version": 2}', "not a route problem of version 1"),
        ('{"version": 1, "visits": []}', "travel: field required"),
        (TEXT.replace("prize", "prise", 1), r"^p:1:\d+: visits\[0\].prise: there is no such field"),
        (
            TEXT.replace("[0, 1, 2]", "[0, 1.5, 2]"),
            r"travel\[0\]\[1\]: input should be a valid int",
        ),
        (TEXT.replace("[0, 1, 2]", "[0, 1]"), "travel: its rows do not have the same length"),
        (TEXT.replace("[0, 1, 2]", f"[{10**30}, 1, 2]"), "too large|valid int"),
        (TEXT.replace("[0, 1, 2]", "[-1, 1, 2]"), "its travel times are not from 0"),
        (TEXT.replace('"members": [0, 1]', '"members": [0, 9]'), "one that is not a visit"),
    ],
)
def test_an_error_names_its_place(text: str, message: str) -> None:
    with pytest.raises(Invalid, match=message):
        parse_route_problem(text, "p")


def test_a_suggestion_as_json_has_its_history() -> None:
    data = json.loads(route_suggestion_text(suggest_route(PROBLEM)))
    assert data["route"]["order"] in ([0, 1], [1, 0])
    assert data["proven"]
    assert {"time", "cost", "bound"} <= set(data["history"][-1])
