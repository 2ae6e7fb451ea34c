"""The travel times of the test sets' sites, kept so that test sets stay as they are.

`python -m baselines.keep_times` finds those that are missing, and keeps them. A change of
the navigator would change them; then the test sets would need new versions, and what was measured
before could not be compared.
"""

import re
from functools import lru_cache
from importlib import resources
from pathlib import Path

import numpy as np

from argo_env.envs.route_site_times import SiteTimes, site_times

_FOLDER = "data"


@lru_cache(maxsize=16)
def kept_times(scenario: str) -> SiteTimes | None:
    """The travel times that are kept of a site; None if there are none."""
    found = resources.files("baselines").joinpath(_FOLDER, _file_name(scenario))
    if not found.is_file():
        return None
    with found.open("rb") as file, np.load(file) as parts:
        return SiteTimes(
            parts["times"], parts["places"], int(parts["floors"]), float(parts["measuring_time"])
        )


def keep_times(scenario: str) -> None:
    """Finds a site's travel times and writes them to where they are kept, in a checkout."""
    folder = Path(__file__).parent / _FOLDER
    folder.mkdir(exist_ok=True)
    site = site_times(scenario)
    np.savez_compressed(
        folder / _file_name(scenario),
        times=site.times.round(3),
        places=site.places,
        floors=site.floors,
        measuring_time=site.measuring_time,
    )


def _file_name(scenario: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", scenario.lower()) + ".npz"
