"""Tests that make the documentation's pictures in their smallest size."""

import pytest

from tests.pictures import evaluation, route_portfolio

pytestmark = pytest.mark.long


@pytest.mark.parametrize("limit", ["0.1", "0.00001"])  # too short for any route
def test_portfolio_picture(tmp_path, limit):
    path = tmp_path / "portfolio.png"
    route_portfolio.main([str(path), "--time-limit", limit, "--workers", "1"])
    assert path.read_bytes().startswith(b"\x89PNG")


def test_evaluation_pictures(tmp_path):
    evaluation.main([str(tmp_path), "--worlds", "2"])
    assert {path.name for path in tmp_path.iterdir()} == {
        "evaluation-rates.png",
        "evaluation-why.png",
    }
