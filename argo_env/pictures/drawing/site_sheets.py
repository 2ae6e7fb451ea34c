"""The sheets of sites, kept from picture to picture."""

from functools import lru_cache

from argo_env.pictures.drawing.floors import FloorPlan, plans_of
from argo_env.pictures.drawing.sheet import FloorSheet, make_sheet
from argo_env.planning import open_site


@lru_cache(maxsize=4)  # a sheet takes 11 MB
def site_sheet(scenario: str, low: int, high: int, asked: tuple[int, ...]) -> FloorSheet:
    """The floors of a site from `low` to `high`; those that are not asked for are pale."""
    plans = [plan for plan in _plans(scenario) if low <= plan.number <= high]
    return make_sheet(plans, [p.number for p in plans if p.number not in asked])


# By name, as a navigator would be kept alive for its plans.
@lru_cache(maxsize=8)
def _plans(scenario: str) -> tuple[FloorPlan, ...]:
    return plans_of(open_site(scenario).site)
