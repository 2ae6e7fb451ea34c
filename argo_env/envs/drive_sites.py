"""The sites that Drive-v0 is asked to drive on, kept ready."""

from pydantic import Field, StrictInt

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.base.model import Model
from argo_env.envs.drive_site import DriveSite
from argo_env.envs.options import LONGEST, check_floors
from argo_env.faults.kinds import AnyFault

NEAREST = 5.0
"""s that a start is away from its goal at least"""
_KEPT = 4  # sites that are kept ready
_NO_SITE = "argo/Drive-v0 needs a `scenario`: the name of a site, or of several"


class DriveOptions(Model):
    """What `reset(options=...)` of Drive-v0 may say."""

    scenario: str | tuple[str, ...] | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: tuple[AnyFault, ...] = ()
    max_way: float | None = Field(default=None, ge=NEAREST, le=LONGEST, strict=True)

    @property
    def floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


class DriveSites:
    """Makes the sites that the options ask for, and `scenarios` where they name none; close it."""

    def __init__(self, scenarios: tuple[str, ...]) -> None:
        if not scenarios:
            raise Invalid(_NO_SITE)
        self.options = DriveOptions()
        self._scenarios = scenarios
        self._ready: dict[str, DriveSite] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Of the sites that an episode may be on."""
        return self._names(self.options)

    def _names(self, options: DriveOptions) -> tuple[str, ...]:
        given = options.scenario
        return self._scenarios if given is None else (given,) if isinstance(given, str) else given

    def choose(self, options: DriveOptions) -> None:
        """Takes the options on; ArgoError if a site does not have what they ask for, and then all
        is as it was."""
        names = self._names(options)
        if not names:
            raise Invalid(_NO_SITE)
        same = options.faults == self.options.faults
        made: dict[str, DriveSite] = {}
        try:
            for name in names:
                site = self._ready.get(name) if same else None
                if site is None:
                    site = made.pop(name, None) or DriveSite(name, options.faults)
                    _keep(made, name, site)
                check_floors(name, site.guide.floors, options.floors)
        except ArgoError:
            for site in made.values():
                site.close()
            raise
        if not same:
            self.close()
        self.options = options
        for name, site in made.items():
            _keep(self._ready, name, site)

    def make(self, name: str) -> DriveSite:
        """The site of that name, ready; the ones used longest ago make room for it."""
        site = self._ready.pop(name, None) or DriveSite(name, self.options.faults)
        _keep(self._ready, name, site)
        return site

    def close(self) -> None:
        """Closes the sites; they are made again when they are asked for."""
        for site in self._ready.values():
            site.close()
        self._ready.clear()


def _keep(sites: dict[str, DriveSite], name: str, site: DriveSite) -> None:
    """Adds the site; the ones added longest ago make room for it."""
    sites[name] = site
    while len(sites) > _KEPT:
        sites.pop(next(iter(sites))).close()
