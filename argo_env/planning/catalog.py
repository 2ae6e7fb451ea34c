"""Catalogues of sites: the names, poses and nominal ranges that the compiler knows."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from argo_compiler.base.catalog import Area, Catalog, CheckpointInfo, Floor, Place
from argo_compiler.base.model import Pose
from argo_compiler.base.stages import stage_items
from argo_env.files.parts import Parts
from argo_env.planning.patrols import find_patrol, load_patrol
from argo_env.site import Site

if TYPE_CHECKING:
    from argo_env.navigation import Navigator


def make_catalog(navigator: "Navigator") -> Catalog:
    """Return the catalogue of the navigator's site, with the patrol of each floor that has one."""
    floors = stage_items("looking for patrols of all floors", navigator.site.spec.floors)
    return _catalog(navigator.site, {f.number: find_patrol(navigator, f.number) for f in floors})


def load_catalog(site: Site, parts: Parts) -> Catalog | None:
    """Return the catalogue of a site from cached patrols; None if that of any floor is missing.

    `parts` is the site's entry of the cache.
    """
    patrols = {}
    for floor in site.spec.floors:
        poses = load_patrol(parts, floor.number)
        if poses is None:
            return None
        patrols[floor.number] = poses
    return _catalog(site, patrols)


def _catalog(site: Site, patrols: Mapping[int, tuple[Pose, ...]]) -> Catalog:
    return Catalog(
        site=site.name,
        checkpoints=tuple(
            CheckpointInfo(
                id=c.id,
                kind=c.kind,
                name=c.name,
                floor=c.floor,
                unit=c.unit,
                range=c.range,
                nominal=c.nominal,
                tags=c.tags,
            )
            for c in site.checkpoints
        ),
        areas=tuple(Area(number=n, dock=pose) for n, pose in sorted(site.docks.items())),
        floors=tuple(
            Floor(number=f.number, z=f.z, patrol=patrols[f.number]) for f in site.spec.floors
        ),
        places=tuple(Place(name=name, pose=pose) for name, pose in site.places.items()),
    )
