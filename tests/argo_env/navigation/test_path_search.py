"""Tests that compare paths found region by region with a search over the whole lattice."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import dijkstra

from argo_compiler.base.errors import NotFound
from argo_compiler.base.model import Pose
from argo_env.navigation import Blockage
from argo_env.navigation.path_search import PathSearch
from argo_env.navigation.regions import find_cut_heights, make_partition
from benchmarks.paths import poses_of_states
from tests.conftest import examples


def path_search(lattice, cuts):
    return PathSearch(lattice, make_partition(lattice, cuts))


@pytest.fixture(scope="module")
def hall_search(hall):
    return path_search(hall.lattice, find_cut_heights(hall.lattice, [0.0, 2.5]))


def cost(lattice, states):
    """Return the cost of a path, each step of which must be a move of the lattice."""
    if len(states) == 1:
        return 0.0
    steps = np.asarray(lattice.costs[states[:-1], states[1:]]).ravel()
    assert (steps > 0).all()
    return float(steps.sum())


def some_states(lattice, seed, count):
    """Return random states, half of them above the ground, the others anywhere."""
    random = np.random.default_rng(seed)
    above = np.flatnonzero(lattice.surface.z[lattice.cell] > 0.3)
    return np.concatenate(
        [random.integers(lattice.size, size=count // 2), random.choice(above, count - count // 2)]
    )


def test_the_cut_goes_through_the_flight_only(hall, hall_search):
    (below, above) = hall_search.partition.regions
    assert len(below.members) + len(above.members) == hall.lattice.size
    sources, _, _ = hall_search.partition.crossings
    x, y, z, yaw = hall.lattice.state_poses(sources).T
    assert 0 < len(sources) <= 20
    assert ((z > 0.1) & (z < 2.4)).all()
    assert ((x > 2.0) & (x < 5.7) & (np.abs(y - 1.55) < 0.5)).all()
    assert np.allclose(yaw, np.pi)  # the front downhill


@settings(max_examples=examples(6), deadline=None)
@given(seed=st.integers(0, 10**6), cuts=st.lists(st.floats(0.05, 2.45), max_size=3, unique=True))
def test_paths_are_the_cheapest_with_any_cuts(hall, seed, cuts):
    """The cases include several cuts through one flight, and none."""
    lattice = hall.lattice
    search = path_search(lattice, sorted(cuts))
    states = some_states(lattice, seed, 4)
    costs = dijkstra(lattice.costs, indices=states)
    for source, reference in zip(states.tolist(), costs, strict=True):
        for goal in states.tolist():
            path = search.find_path(source, (np.array([goal]), np.zeros(1)))
            assert path[0] == source
            assert path[-1] == goal
            assert cost(lattice, path) == pytest.approx(reference[goal], abs=1e-6)


@settings(max_examples=examples(6), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_best_of_several_goals(hall, hall_search, seed):
    lattice = hall.lattice
    source, *goals = some_states(lattice, seed, 9).tolist()
    extra = np.random.default_rng(seed).uniform(0.0, 20.0, len(goals))
    path = hall_search.find_path(source, (np.array(goals), extra))
    total = dijkstra(lattice.costs, indices=source)[goals] + extra
    arrived = extra[[k for k, goal in enumerate(goals) if goal == path[-1]]].min()
    assert cost(lattice, path) + arrived == pytest.approx(total.min(), abs=1e-6)


@settings(max_examples=examples(3), deadline=None)
@given(seed=st.integers(0, 10**6), closing=st.booleans())
def test_paths_in_a_large_region_with_landmarks_are_the_cheapest(navigator, umad, seed, closing):
    """The cases include moves removed after the landmarks were computed, and several goals."""
    random = np.random.default_rng(seed)
    if closing:
        x, y = random.uniform((2.0, -3.0), (14.0, 12.0)).tolist()
        navigator = navigator.with_added_blockages(
            [Blockage((x, y, x + 1.5, y + 1.5), umad.spec.ground_z, "a brick")]
        )
    lattice = navigator.lattice
    search = navigator._path_search
    ground = np.flatnonzero(np.abs(lattice.state_poses()[:, 2] - umad.spec.ground_z) < 0.1)
    sources, goals = random.choice(ground, size=(2, 3))
    extra = random.uniform(0.0, 20.0, 3)
    costs = dijkstra(lattice.costs, indices=sources)
    for source, reference in zip(sources.tolist(), costs, strict=True):
        wanted = [(goals[[k]], np.zeros(1), reference[goals[k]]) for k in range(3)]
        wanted.append((goals, extra, (reference[goals] + extra).min()))
        for ends, more, lowest in wanted:
            path = search.find_path(source, (ends, more))
            if path is None:
                assert lowest == np.inf
                continue
            arrived = more[ends == path[-1]].min()
            assert path[0] == source
            assert cost(lattice, path) + arrived == pytest.approx(lowest, abs=1e-6)


def test_earlier_queries_make_no_difference(hall, hall_search):
    states = some_states(hall.lattice, 3, 4).tolist()
    again = path_search(hall.lattice, find_cut_heights(hall.lattice, [0.0, 2.5]))
    for source in reversed(states):
        for goal in states:
            goals = (np.array([goal]), np.zeros(1))
            assert again.find_path(source, goals) == hall_search.find_path(source, goals)


def test_times_are_those_of_the_cheapest_paths(hall, hall_search):
    lattice = hall.lattice
    states = some_states(lattice, 4, 6)
    times = hall_search.travel_times(states)
    costs = dijkstra(lattice.costs, indices=states)[:, states]
    assert np.diag(times).tolist() == [0.0] * len(states)
    # With little clearance a second costs a little more.
    assert (times <= costs + 1e-6).all()
    assert (times >= costs / 1.2 - 1e-6).all()
    for a, source in enumerate(states.tolist()):
        for b, goal in enumerate(states.tolist()):
            path = np.array(hall_search.find_path(source, (np.array([goal]), np.zeros(1))))
            steps = (
                np.asarray(lattice.costs[path[:-1], path[1:]]).ravel() if a != b else np.zeros(0)
            )
            roomy = lattice.roomy[path[:-1]] & lattice.roomy[path[1:]]
            seconds = (steps / np.where(roomy, 1.0, 1.2)).sum()
            # Paths of equal cost may differ in time, but hardly.
            assert times[a, b] == pytest.approx(seconds, rel=0.02, abs=1e-6)


def test_travel_times_of_checkpoints_and_poses(hall, robot):
    ids = [c.id for c in hall.site.checkpoints]
    dock = hall.snap_keeping_heading(hall.site.docks[1])
    locations = [dock, *ids]
    times = hall.travel_times(locations)
    assert times.shape == (7, 7)
    poses = [dock, *(hall.viewing_pose(id) for id in ids)]
    assert hall.travel_times(poses).tolist() == times.tolist()
    for pose, row in zip(poses, times.tolist(), strict=True):
        assert hall.travel_times_from(pose, poses).tolist() == row
    for a, start in enumerate(poses):
        for b, goal in enumerate(poses):
            # The driven path cuts corners, and its slopes are measured from end to end; the lattice
            # counts the time lost with each motion by its turns only.
            path = hall.plan(start, goal)
            duration = path.duration(robot)
            lost = sum(robot.calibration.pace_for(m.kind).lost for m in path.motions)
            assert duration <= 1.01 * times[a, b] + lost + 0.01
            assert times[a, b] <= 1.3 * duration + 4.0
    # Climbing is slower than descending.
    assert times[0, 4] > times[4, 0]
    assert hall.plan_to_view(hall.site.docks[1], 4).end == hall.viewing_pose(4)


def test_travel_times_of_no_locations_and_of_unknown_ones(hall):
    assert hall.travel_times([]).shape == (0, 0)
    with pytest.raises(NotFound):
        hall.travel_times([1, 99])
    with pytest.raises(Exception, match="no place that the robot can reach"):
        hall.travel_times([Pose(x=50.0, y=0.0, z=0.0)])


@settings(max_examples=examples(10), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_travel_times_from_all_states_are_those_from_each_state(hall, seed):
    ids = [c.id for c in hall.site.checkpoints]
    everywhere = hall.travel_times_to([hall.site.docks[1], *ids])
    assert everywhere.shape == (len(ids) + 1, hall.lattice.size)
    for state in some_states(hall.lattice, seed, 8):
        (here,) = poses_of_states(hall, np.array([state]))
        assert hall.state_at(here) == state
        row = hall.travel_times_from(here, [hall.site.docks[1], *ids])
        assert everywhere[:, state] == pytest.approx(row, rel=0.02, abs=1e-4)
