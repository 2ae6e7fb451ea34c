"""Ways found region by region, against one search over the whole lattice."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import dijkstra

from argo_compiler.base.errors import NotFound
from argo_compiler.base.model import Pose
from argo_env.navigation import Blockage
from argo_env.navigation.regions import find_cuts, make_partition
from argo_env.navigation.routes import Routes
from benchmarks.paths import poses
from tests.conftest import examples


def routes(lattice, cuts):
    return Routes(lattice, make_partition(lattice, cuts))


@pytest.fixture(scope="module")
def found(hall):
    return routes(hall.lattice, find_cuts(hall.lattice, [0.0, 2.5]))


def cost(lattice, way):
    """Of a way whose every step is a move of the lattice."""
    if len(way) == 1:
        return 0.0
    steps = np.asarray(lattice.costs[way[:-1], way[1:]]).ravel()
    assert (steps > 0).all()
    return float(steps.sum())


def some_states(lattice, seed, count):
    """Half of them anywhere, most of which are on the ground, and half above it."""
    random = np.random.default_rng(seed)
    above = np.flatnonzero(lattice.surface.z[lattice.cell] > 0.3)
    return np.concatenate(
        [random.integers(lattice.size, size=count // 2), random.choice(above, count - count // 2)]
    )


def test_the_cut_goes_through_the_flight_only(hall, found):
    (below, above) = found.partition.regions
    assert len(below.members) + len(above.members) == hall.lattice.size
    sources, _, _ = found.partition.crossings
    x, y, z, yaw = hall.lattice.poses(sources).T
    assert 0 < len(sources) <= 20
    assert ((z > 0.1) & (z < 2.4)).all()
    assert ((x > 2.0) & (x < 5.7) & (np.abs(y - 1.55) < 0.5)).all()
    assert np.allclose(yaw, np.pi)  # the front downhill


@settings(max_examples=examples(6), deadline=None)
@given(seed=st.integers(0, 10**6), cuts=st.lists(st.floats(0.05, 2.45), max_size=3, unique=True))
def test_wherever_it_is_cut_the_ways_are_the_cheapest(hall, seed, cuts):
    """Also with several cuts through one flight, and with none."""
    lattice = hall.lattice
    cut = routes(lattice, sorted(cuts))
    states = some_states(lattice, seed, 4)
    costs = dijkstra(lattice.costs, indices=states)
    for source, reference in zip(states.tolist(), costs, strict=True):
        for goal in states.tolist():
            way = cut.find(source, (np.array([goal]), np.zeros(1)))
            assert way[0] == source
            assert way[-1] == goal
            assert cost(lattice, way) == pytest.approx(reference[goal], abs=1e-6)


@settings(max_examples=examples(6), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_best_of_several_goals(hall, found, seed):
    lattice = hall.lattice
    source, *goals = some_states(lattice, seed, 9).tolist()
    extra = np.random.default_rng(seed).uniform(0.0, 20.0, len(goals))
    way = found.find(source, (np.array(goals), extra))
    total = dijkstra(lattice.costs, indices=source)[goals] + extra
    arrived = extra[[k for k, goal in enumerate(goals) if goal == way[-1]]].min()
    assert cost(lattice, way) + arrived == pytest.approx(total.min(), abs=1e-6)


@settings(max_examples=examples(3), deadline=None)
@given(seed=st.integers(0, 10**6), closing=st.booleans())
def test_landmarks_of_a_large_region_lose_no_way(navigator, umad, seed, closing):
    """Also where moves are gone since the landmarks were found, and to the best of many goals."""
    random = np.random.default_rng(seed)
    if closing:
        x, y = random.uniform((2.0, -3.0), (14.0, 12.0)).tolist()
        navigator = navigator.avoiding(
            [Blockage((x, y, x + 1.5, y + 1.5), umad.spec.ground_z, "a brick")]
        )
    lattice = navigator.lattice
    found = navigator._routes
    ground = np.flatnonzero(np.abs(lattice.poses()[:, 2] - umad.spec.ground_z) < 0.1)
    sources, goals = random.choice(ground, size=(2, 3))
    extra = random.uniform(0.0, 20.0, 3)
    costs = dijkstra(lattice.costs, indices=sources)
    for source, reference in zip(sources.tolist(), costs, strict=True):
        wanted = [(goals[[k]], np.zeros(1), reference[goals[k]]) for k in range(3)]
        wanted.append((goals, extra, (reference[goals] + extra).min()))
        for ends, more, least in wanted:
            way = found.find(source, (ends, more))
            if way is None:
                assert least == np.inf
                continue
            arrived = more[ends == way[-1]].min()
            assert way[0] == source
            assert cost(lattice, way) + arrived == pytest.approx(least, abs=1e-6)


def test_what_was_asked_before_makes_no_difference(hall, found):
    states = some_states(hall.lattice, 3, 4).tolist()
    again = routes(hall.lattice, find_cuts(hall.lattice, [0.0, 2.5]))
    for source in reversed(states):
        for goal in states:
            goals = (np.array([goal]), np.zeros(1))
            assert again.find(source, goals) == found.find(source, goals)


def test_times_are_those_of_the_cheapest_ways(hall, found):
    lattice = hall.lattice
    states = some_states(lattice, 4, 6)
    times = found.times(states)
    costs = dijkstra(lattice.costs, indices=states)[:, states]
    assert np.diag(times).tolist() == [0.0] * len(states)
    # With little room a second counts a little more.
    assert (times <= costs + 1e-6).all()
    assert (times >= costs / 1.2 - 1e-6).all()
    for a, source in enumerate(states.tolist()):
        for b, goal in enumerate(states.tolist()):
            way = np.array(found.find(source, (np.array([goal]), np.zeros(1))))
            steps = np.asarray(lattice.costs[way[:-1], way[1:]]).ravel() if a != b else np.zeros(0)
            roomy = lattice.roomy[way[:-1]] & lattice.roomy[way[1:]]
            seconds = (steps / np.where(roomy, 1.0, 1.2)).sum()
            # Ways that cost the same may differ in time, but hardly.
            assert times[a, b] == pytest.approx(seconds, rel=0.02, abs=1e-6)


def test_travel_times_of_checkpoints_and_poses(hall, robot):
    ids = [c.id for c in hall.site.checkpoints]
    dock = hall.snap(hall.site.docks[1])
    places = [dock, *ids]
    times = hall.travel_times(places)
    assert times.shape == (7, 7)
    poses = [dock, *(hall.viewing_pose(id) for id in ids)]
    assert hall.travel_times(poses).tolist() == times.tolist()
    for place, row in zip(poses, times.tolist(), strict=True):
        assert hall.travel_times_from(place, poses).tolist() == row
    for a, start in enumerate(poses):
        for b, goal in enumerate(poses):
            # Corners are cut on the way that is driven; slopes are measured end to end; the lattice
            # counts the time lost with each motion by its turns only.
            path = hall.plan(start, goal)
            duration = path.duration(robot)
            lost = sum(robot.calibration.pace_for(m.kind).lost for m in path.motions)
            assert duration <= 1.01 * times[a, b] + lost + 0.01
            assert times[a, b] <= 1.3 * duration + 4.0
    # Up the stairs is slower than down.
    assert times[0, 4] > times[4, 0]
    assert hall.plan_to_view(hall.site.docks[1], 4).end == hall.viewing_pose(4)


def test_travel_times_of_nothing_and_of_what_is_not_there(hall):
    assert hall.travel_times([]).shape == (0, 0)
    with pytest.raises(NotFound):
        hall.travel_times([1, 99])
    with pytest.raises(Exception, match="no place that the robot can reach"):
        hall.travel_times([Pose(x=50.0, y=0.0, z=0.0)])


@settings(max_examples=examples(10), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_from_everywhere_it_takes_as_long_as_from_each_place(hall, seed):
    ids = [c.id for c in hall.site.checkpoints]
    everywhere = hall.travel_times_to([hall.site.docks[1], *ids])
    assert everywhere.shape == (len(ids) + 1, hall.lattice.size)
    for state in some_states(hall.lattice, seed, 8):
        (here,) = poses(hall, np.array([state]))
        assert hall.state_at(here) == state
        row = hall.travel_times_from(here, [hall.site.docks[1], *ids])
        assert everywhere[:, state] == pytest.approx(row, rel=0.02, abs=1e-4)
