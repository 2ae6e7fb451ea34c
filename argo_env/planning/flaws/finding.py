"""Looks a site over: whether it can be driven, and what is in the way of it."""

from dataclasses import dataclass

from argo_compiler.base.errors import ArgoError
from argo_env.navigation import Navigator
from argo_env.planning.checking import unseen_checkpoints, unserved_floors
from argo_env.planning.flaws.checkpoints import checkpoint_flaws
from argo_env.planning.flaws.docks import dock_flaws
from argo_env.planning.flaws.flaw import Flaw, Mark
from argo_env.planning.flaws.floors import floor_flaws, lost_floors
from argo_env.planning.flaws.standing import Standing
from argo_env.site.norms import false_ends


@dataclass(frozen=True)
class SiteCheck:
    """What is wrong with a site, and where the robot can stand on it if something is."""

    flaws: tuple[Flaw, ...]
    standing: Standing | None = None


def look_over(navigator: Navigator) -> SiteCheck:
    """Looks for what the robot can't reach, from the docking stations and back."""
    site = navigator.site
    unled = _unled_places(navigator) if _docks_serve(navigator) else None
    if unled == [] and not (
        false_ends(site.spec) or unserved_floors(navigator) or unseen_checkpoints(navigator)
    ):
        return SiteCheck(())
    standing = Standing.of(navigator)
    if ends := false_ends(site.spec):
        # What can't be reached for that is found again once they are mended.
        return SiteCheck(tuple(Flaw(end) for end in ends), standing)
    if unled is None or dock_flaws(standing):
        return SiteCheck(tuple(dock_flaws(standing)), standing)
    flaws = (
        *floor_flaws(standing, navigator),
        *checkpoint_flaws(standing, navigator, lost_floors(standing)),
        *unled,
    )
    return SiteCheck(flaws, standing)


def _docks_serve(navigator: Navigator) -> bool:
    try:
        navigator.prepare()
    except ArgoError:
        return False
    return True


def _unled_places(navigator: Navigator) -> list[Flaw]:
    """The named places that the robot gets to no pose near of."""
    flaws = []
    for name, pose in navigator.site.places.items():
        try:
            navigator.snap(pose)
        except ArgoError as error:
            flaws.append(Flaw(f"place {name}: {error}; move it", (Mark(1, pose.x, pose.y),)))
    return flaws
