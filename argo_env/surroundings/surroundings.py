"""The surroundings of the robot: the sources of gas, heat and sound out of the ordinary that are
there now, since when, the weather, and where the wireless network has a signal. What they send out
is in the modules beside this one; how the robot senses it, in `argo_env.sensing.signals`."""

from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.base.errors import NotFound
from argo_env.robot.pose import BodyPose
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect


class PumpFault(StrEnum):
    """What can be wrong with a running pump."""

    BEARING = "bearing"
    """a spall in the outer race: a burst of ringing each time that a ball rolls over it"""
    CAVITATION = "cavitation"
    """bubbles that collapse in the impeller: loud broadband noise"""


@dataclass(frozen=True)
class GasLeak:
    """Natural gas that escapes at `place` (m) with `rate` (kg/s), and hisses."""

    place: Vector
    rate: float = 0.02


@dataclass(frozen=True)
class HotSpot:
    """A glowing ball about `place` (m) of `radius` (m) and `temperature` (°C), half sunk into what
    it lies on."""

    place: Vector
    radius: float = 0.15
    temperature: float = 90.0


@dataclass(frozen=True)
class PumpSound:
    """The pump of the site with the name `pump` runs with a fault. All other pumps run well."""

    pump: str
    fault: PumpFault = PumpFault.BEARING


@dataclass(frozen=True)
class Alarm:
    """The general platform alarm sounds, from loudspeakers all over the site, with `level` (dB)."""

    level: float = 85.0


Source = GasLeak | HotSpot | PumpSound | Alarm


@dataclass(frozen=True)
class Weather:
    """The weather, the same all over the site."""

    wind: tuple[float, float] = (0.8, 0.4)
    """m/s along x and y, where it blows to"""
    diffusivity: float = 0.3
    """m²/s, of the eddies"""
    temperature: float = 20.0
    """°C, of the air"""
    sun: Vector = (-0.5, -0.5, 0.707)
    """a vector of length 1 towards the sun, or of length 0 at night"""


@dataclass(frozen=True)
class Release:
    """Gas that has escaped from a leak between `start` and `end` (s); None: it goes on."""

    leak: GasLeak
    start: float
    end: float | None = None


class Surroundings:
    """Holds the sources that are there now. Gas that has escaped stays until it has dispersed."""

    def __init__(self, site: Site, weather: Weather | None = None) -> None:
        self.site = site
        self.weather = weather or Weather()
        self._there: list[tuple[Source, float]] = []  # and since when
        self._ended: list[Release] = []

    @property
    def sources(self) -> tuple[Source, ...]:
        """The sources that are there now, in the order in which they came; equal ones add up."""
        return tuple(source for source, _ in self._there)

    @property
    def releases(self) -> tuple[Release, ...]:
        """All gas that escapes or has escaped."""
        now = [Release(s, t) for s, t in self._there if isinstance(s, GasLeak)]
        return (*self._ended, *now)

    def add(self, source: Source, now: float = 0.0) -> None:
        """From time `now` (s) on the source is there, beside equal ones that are there already.

        Raises ArgoError for a pump that the site does not have.
        """
        if isinstance(source, PumpSound):
            known = [pump.name for floor in self.site.spec.floors for pump in floor.pumps]
            if source.pump not in known:
                names = ", ".join(known) or "none"
                raise NotFound(
                    f"site {self.site.name} has no pump `{source.pump}`; there are: {names}"
                )
        self._there.append((source, now))

    def remove(self, source: Source, now: float = 0.0) -> None:
        """From time `now` (s) on the source is gone, of equal ones that which came first.

        Raises NotFound if it is not there.
        """
        first = next((k for k, (there, _) in enumerate(self._there) if there == source), None)
        if first is None:
            raise NotFound(f"site {self.site.name} has no such source: {source}")
        _, start = self._there.pop(first)
        if isinstance(source, GasLeak):
            self._ended.append(Release(source, start, now))


@dataclass(frozen=True)
class Shadow:
    """A part of the site without a signal; what is None does not limit it."""

    rect: Rect | None = None
    floor: int | None = None

    def holds(self, pose: BodyPose, site: Site) -> bool:
        """Whether a robot at `pose` is in it."""
        if self.floor is not None and site.floor_at(pose.z) != self.floor:
            return False
        if self.rect is None:
            return True
        x0, y0, x1, y1 = self.rect
        return x0 <= pose.x <= x1 and y0 <= pose.y <= y1


class RadioNetwork:
    """The network of a site. Holds the shadows that are there now."""

    def __init__(self, site: Site) -> None:
        self._site = site
        self.shadows: list[Shadow] = []

    def connected(self, pose: BodyPose) -> bool:
        """Whether a robot at `pose` has a connection."""
        return not any(shadow.holds(pose, self._site) for shadow in self.shadows)
