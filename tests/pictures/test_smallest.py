"""The pictures of the documentation in their smallest size."""

import pytest

from tests.pictures import evaluation, route_portfolio

pytestmark = pytest.mark.long


def test_the_portfolio_at_work(tmp_path):
    path = tmp_path / "portfolio.png"
    route_portfolio.main([str(path), "--time-limit", "0.1", "--workers", "1"])
    assert path.read_bytes().startswith(b"\x89PNG")


def test_an_evaluation(tmp_path):
    evaluation.main([str(tmp_path), "--worlds", "2"])
    assert {path.name for path in tmp_path.iterdir()} == {
        "evaluation-rates.png",
        "evaluation-why.png",
    }
