"""A site that is ready for work: the one way to get geometry, paths, names and travel times."""

from functools import cached_property, lru_cache
from pathlib import Path

from argo_compiler.catalog import Catalog
from argo_env.navigation import Navigator
from argo_env.planning.catalog import make_catalog
from argo_env.planning.generated import generate
from argo_env.planning.travel import SiteTravel
from argo_env.robot.spec import RobotSpec, load_robot
from argo_env.site import Site, load_site
from argo_env.site.family import is_family, parse_family

_KEPT = 8  # a navigator holds some 100 MB


class OpenedSite:
    """A site with all that planning and driving on it need. Keeps what it has worked out."""

    def __init__(self, reference: str, navigator: Navigator) -> None:
        self.reference = reference
        """what opens it again: the site's name, the whole path of its file, or its parameters"""
        self.navigator = navigator

    @property
    def site(self) -> Site:
        return self.navigator.site

    @property
    def robot(self) -> RobotSpec:
        return self.navigator.robot

    @property
    def name(self) -> str:
        return self.site.name

    @cached_property
    def catalog(self) -> Catalog:
        """What scripts may name on the site."""
        return make_catalog(self.navigator)

    @cached_property
    def travel(self) -> SiteTravel:
        """Travel times and energy, for the analysis and for routes."""
        return SiteTravel(self.navigator)


def open_site(reference: str = "umad") -> OpenedSite:
    """The site of that name, the one that the file `reference` describes, or a generated one such
    as `generated:floors=3,seed=7`, ready for work.

    Raises ArgoError if there is no such site, it makes no sense, or the robot can't drive there.
    """
    path = Path(reference)
    if path.suffix in {".yaml", ".yml"}:
        return _opened(str(path.resolve()))
    return _opened(reference)


@lru_cache(maxsize=_KEPT)
def _opened(reference: str) -> OpenedSite:
    if is_family(reference):
        return OpenedSite(reference, generate(parse_family(reference)))
    return OpenedSite(reference, Navigator(load_site(reference), load_robot()))
