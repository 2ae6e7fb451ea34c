"""Stored travel times of the test sets' sites, so that the test sets never change.

Otherwise a change of the navigator would change them, and earlier results could not be compared
with later ones. `python -m baselines.keep_times` computes and stores those that are missing.
"""

import re
from functools import lru_cache
from importlib import resources
from pathlib import Path

import numpy as np

from argo_env.envs.route_site_times import SiteTimes, site_times

_FOLDER = "data"


@lru_cache(maxsize=16)
def load_site_times(scenario: str) -> SiteTimes | None:
    """Return the stored travel times of a site; None if there are none."""
    path = resources.files("baselines").joinpath(_FOLDER, _file_name(scenario))
    if not path.is_file():
        return None
    with path.open("rb") as file, np.load(file) as parts:
        return SiteTimes(
            parts["times"], parts["places"], int(parts["floors"]), float(parts["measuring_time"])
        )


def store_site_times(scenario: str) -> None:
    """Compute the travel times of a site and write them into `baselines/data` of a checkout."""
    folder = Path(__file__).parent / _FOLDER
    folder.mkdir(exist_ok=True)
    site = site_times(scenario)
    np.savez_compressed(
        folder / _file_name(scenario),
        times=site.times.round(3),
        places=site.positions,
        floors=site.floors,
        measuring_time=site.measuring_time,
    )


def _file_name(scenario: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", scenario.lower()) + ".npz"
