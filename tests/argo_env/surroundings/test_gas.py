"""The plume solves the advection-diffusion equation, and conserves the mass of the gas."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.surroundings import GasLeak, Weather
from argo_env.surroundings.gas import DENSITY, concentration, leak_concentration
from argo_env.surroundings.surroundings import Release
from tests.conftest import examples

FAR_BELOW = -1e4  # m: a ground that is too far away to reflect gas
LEAK = GasLeak((0.0, 0.0, 1.0), 0.02)
WINDS = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))


def share(points, age, weather, ground=FAR_BELOW):
    """Return the concentration as a share from 0 to 1, not in ppm."""
    return leak_concentration(LEAK, weather, ground, np.asarray(points, dtype=float), age) / 1e6


@settings(deadline=None, max_examples=examples(60))
@given(
    WINDS,
    st.floats(0.1, 1.0),
    st.floats(2.0, 200.0),
    st.tuples(st.floats(0.5, 6.0), st.floats(0, 2 * np.pi), st.floats(-1.5, 1.5)),
)
def test_it_solves_the_advection_diffusion_equation(wind, k, age, offset):
    weather = Weather(wind=wind, diffusivity=k)
    r, turn, up = offset
    point = np.array([r * np.cos(turn), r * np.sin(turn), 1.0 + up])
    h, dt = 1e-2, 1e-3
    c = share([point], age, weather)[0]
    change = (share([point], age + dt, weather)[0] - share([point], age - dt, weather)[0]) / (
        2 * dt
    )
    sides = [(share([point + h * e], age, weather)[0], share([point - h * e], age, weather)[0])
             for e in np.eye(3)]  # fmt: skip
    carried = sum(u * (a - b) / (2 * h) for u, (a, b) in zip((*wind, 0.0), sides, strict=True))
    curved = [k * (a - 2 * c + b) / h**2 for a, b in sides]
    size = abs(change) + abs(carried) + sum(map(abs, curved)) + 1e-12
    assert abs(change + carried - sum(curved)) < 0.01 * size


@pytest.mark.parametrize("wind", [(0.0, 0.0), (0.8, 0.4), (-1.0, 0.2)])
@pytest.mark.parametrize("age", [5.0, 20.0])
def test_all_that_has_escaped_is_in_the_air(wind, age):
    weather = Weather(wind=wind)
    cell, reach = 0.4, 6 * np.sqrt(2 * weather.diffusivity * age)
    axes = [
        np.arange(min(0, u * age) - reach, max(0, u * age) + reach, cell) + 0.13 for u in (*wind, 0)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    grid[:, 2] += 1.0
    volume = share(grid, age, weather).sum() * cell**3
    assert volume == pytest.approx(LEAK.rate / DENSITY * age, rel=0.03)


def test_the_flux_through_a_plane_downwind_is_the_rate():
    weather = Weather(wind=(1.0, 0.0))
    side = np.arange(-12, 12, 0.15)
    y, z = (g.ravel() for g in np.meshgrid(side, side + 1.0))
    x, h = 4.0, 1e-3

    def plane(x):
        return share(np.column_stack([np.full(y.size, x), y, z]), 1e5, weather)

    slope = (plane(x + h) - plane(x - h)) / (2 * h)
    flux = (weather.wind[0] * plane(x) - weather.diffusivity * slope).sum() * 0.15**2
    assert flux == pytest.approx(LEAK.rate / DENSITY, rel=0.02)


@settings(deadline=None, max_examples=examples(60))
@given(st.floats(0.2, 1.5), st.floats(0.5, 8.0), st.floats(0.3, 4.0), st.floats(5.0, 300.0))
def test_it_falls_downwind_and_to_the_sides_and_is_less_upwind(u, x, aside, age):
    weather = Weather(wind=(u, 0.0))
    near, far, beside, upwind = share(
        [(x, 0, 1), (x + 1, 0, 1), (x, aside, 1), (-x, 0, 1)], age, weather
    )
    assert near > far >= 0
    assert near > beside
    assert near > upwind


@settings(deadline=None, max_examples=examples(60))
@given(WINDS, st.floats(0.5, 8.0), st.floats(0, 2 * np.pi))
def test_it_grows_from_its_start_and_disperses_after_its_end(wind, r, turn):
    weather = Weather(wind=wind)
    point = np.array([[r * np.cos(turn), r * np.sin(turn), 1.5]])
    ages = [-1.0, 0.0, 3.0, 10.0, 30.0, 100.0]
    levels = [concentration(Release(LEAK, 50.0), weather, 0.0, point, 50.0 + a)[0] for a in ages]
    assert levels[:2] == [0.0, 0.0]
    assert levels == sorted(levels)
    ended = Release(LEAK, 50.0, 150.0)
    after = [concentration(ended, weather, 0.0, point, 150.0 + a)[0] for a in (0.0, 300.0, 3000.0)]
    assert after[0] == pytest.approx(levels[-1])
    assert after[2] <= after[1] + 1e-9
    assert after[2] < 60.0


def test_the_ground_lets_nothing_through():
    weather = Weather()
    above, below = leak_concentration(
        LEAK, weather, 0.0, np.array([[3, 1, 1e-4], [3, 1, -1e-4]]), 40.0
    )
    assert above == pytest.approx(below)
    assert (
        above > leak_concentration(LEAK, weather, FAR_BELOW, np.array([[3.0, 1.0, 0.0]]), 40.0)[0]
    )


def test_it_is_finite_everywhere():
    points = np.array([[0, 0, 1.0], [500, 0, 1], [-500, 0, 1], [0, 0, 1 + 1e-9]])
    for age in (1e-6, 1.0, 1e6):
        values = concentration(Release(LEAK, 0.0), Weather(wind=(5, 0)), 0.0, points, age)
        assert np.isfinite(values).all()
        assert (values >= 0).all()
