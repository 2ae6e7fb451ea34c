"""The map's rays end where they do in PyBullet's world of the same site."""

import numpy as np
import pytest

from argo_env.sensing.signals.site_map import SiteMap

REACH = 5.0


@pytest.mark.parametrize("seed", range(12))
def test_rays_on_the_map_end_where_they_do_in_the_world(umad, simulated_world, navigator, seed):
    rng = np.random.default_rng(seed)
    positions = navigator.surface.cell_positions()
    origin = positions[rng.integers(len(positions))] + [0.0, 0.0, rng.uniform(0.3, 0.9)]
    turn, spread = rng.uniform(0, 2 * np.pi), [0.3, 1.0, 3.0][seed % 3]
    around, up = turn + rng.uniform(-spread, spread, 150), rng.uniform(-1.2, 0.8, 150)
    rays = np.column_stack([np.cos(around) * np.cos(up), np.sin(around) * np.cos(up), np.sin(up)])
    on_map, solids = SiteMap(umad).cast_rays(origin, rays, REACH)
    in_world = simulated_world.hit_distances_or_inf(tuple(origin.tolist()), origin + REACH * rays)
    differ = np.abs(np.minimum(on_map, REACH) - np.minimum(in_world, REACH)) > 0.01
    # The bodies of checkpoints are not on the map, and edges differ slightly.
    assert differ.sum() <= 0.05 * len(rays)
    assert np.array_equal(np.isfinite(on_map), solids >= 0)


def test_the_nearest_equipment_is_named(site_map):
    assert site_map.nearest_equipment((6.0, 2.5, 1.5)) == "pipe 1"
    assert site_map.nearest_equipment((3.2, 4.0, 1.5)) == "pump P-1"
    assert site_map.nearest_equipment((15.0, 5.0, 1.5)) == "vessel V-1"


def test_a_ray_into_the_sky_ends_nowhere(site_map):
    distances, solids = site_map.cast_rays(
        np.array([-3.0, -3.0, 5.0]), np.array([[0.0, 0.0, 1.0]]), REACH
    )
    assert (distances[0], solids[0]) == (np.inf, -1)
    assert not site_map.walkable(solids).any()
