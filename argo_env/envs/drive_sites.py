"""The sites that Drive-v0 is asked to drive on, kept ready."""

from pydantic import Field

from argo_compiler.errors import ArgoError
from argo_compiler.model import Model
from argo_env.envs.drive_site import DriveSite
from argo_env.events.kinds import AnyFault

_KEPT = 4  # sites that are kept ready


class DriveOptions(Model):
    """What `reset(options=...)` of Drive-v0 may say."""

    scenario: str | tuple[str, ...] | None = None
    floor: int | tuple[int, ...] = ()
    faults: tuple[AnyFault, ...] = ()
    max_way: float | None = Field(default=None, gt=0)

    @property
    def floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


class DriveSites:
    """Makes the sites that the options ask for, and `scenarios` where they name none; close it."""

    def __init__(self, scenarios: tuple[str, ...]) -> None:
        self.options = DriveOptions()
        self._scenarios = scenarios
        self._ready: dict[str, DriveSite] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Of the sites that an episode may be on."""
        given = self.options.scenario
        return self._scenarios if given is None else (given,) if isinstance(given, str) else given

    def choose(self, options: DriveOptions) -> None:
        """Takes the options on; ArgoError if a site does not have what they ask for."""
        before = self.options
        if options.faults != before.faults:
            self.close()
        self.options = options
        try:
            for name in self.names:
                site = self.make(name)
                for floor in options.floors:
                    if floor not in site.guide.floors:
                        known = ", ".join(map(str, site.guide.floors))
                        raise ArgoError(f"site {name} has the floors {known}, not {floor}")
        except ArgoError:
            if options.faults != before.faults:
                self.close()
            self.options = before
            raise

    def make(self, name: str) -> DriveSite:
        """The site of that name, ready; the ones used longest ago make room for it."""
        site = self._ready.pop(name, None) or DriveSite(name, self.options.faults)
        self._ready[name] = site
        while len(self._ready) > _KEPT:
            self._ready.pop(next(iter(self._ready))).close()
        return site

    def close(self) -> None:
        """Closes the sites; they are made again when they are asked for."""
        for site in self._ready.values():
            site.close()
        self._ready.clear()
