"""Surroundings of the robot: abnormal sources of gas, heat and sound, the weather, and the network.

The fields of the sources are in the other modules of this package; how the robot senses them, in
`argo_env.sensing.signals`.
"""

from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.base.errors import NotFound
from argo_env.robot.pose import BodyPose
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect


class PumpFault(StrEnum):
    """Fault of a running pump."""

    BEARING = "bearing"
    """a spall in the outer race: a burst of ringing each time that a ball rolls over it"""
    CAVITATION = "cavitation"
    """bubbles that collapse in the impeller: loud broadband noise"""


@dataclass(frozen=True)
class GasLeak:
    """Leak of natural gas, which hisses."""

    place: Vector
    """m"""
    rate: float = 0.02
    """kg/s"""


@dataclass(frozen=True)
class HotSpot:
    """Hot spot: a glowing ball, half sunk into the surface that it lies on."""

    place: Vector
    """m, middle of the ball"""
    radius: float = 0.15
    """m"""
    temperature: float = 90.0
    """°C"""


@dataclass(frozen=True)
class PumpSound:
    """Sound of a pump that runs with a fault; pumps without such a source run well."""

    pump: str
    """name of the pump"""
    fault: PumpFault = PumpFault.BEARING


@dataclass(frozen=True)
class Alarm:
    """General platform alarm, from loudspeakers all over the site."""

    level: float = 85.0
    """dB"""


Source = GasLeak | HotSpot | PumpSound | Alarm


@dataclass(frozen=True)
class Weather:
    """The weather, the same all over the site."""

    wind: tuple[float, float] = (0.8, 0.4)
    """m/s along x and y: velocity of the air"""
    diffusivity: float = 0.3
    """m²/s, of the eddies"""
    temperature: float = 20.0
    """°C, of the air"""
    sun: Vector = (-0.5, -0.5, 0.707)
    """vector of length 1 towards the sun, or of length 0 at night"""


@dataclass(frozen=True)
class Release:
    """Gas that escapes, or has escaped, from a leak."""

    leak: GasLeak
    start: float
    """s"""
    end: float | None = None
    """s; None if gas still escapes"""


class Surroundings:
    """Sources that are active now, with the gas that has escaped from earlier leaks."""

    def __init__(self, site: Site, weather: Weather | None = None) -> None:
        self.site = site
        self.weather = weather or Weather()
        self._active: list[tuple[Source, float]] = []  # and since when
        self._ended: list[Release] = []

    @property
    def sources(self) -> tuple[Source, ...]:
        """Sources that are active now, in the order in which they began, equal ones included."""
        return tuple(source for source, _ in self._active)

    @property
    def releases(self) -> tuple[Release, ...]:
        """Gas that has escaped from leaks that ended, then gas that escapes now."""
        now = [Release(s, t) for s, t in self._active if isinstance(s, GasLeak)]
        return (*self._ended, *now)

    def add(self, source: Source, now: float = 0.0) -> None:
        """Add a source that is active from time `now` (s) on, even if an equal one is active.

        Raises NotFound if the site does not have the source's pump.
        """
        if isinstance(source, PumpSound):
            known = [pump.name for floor in self.site.spec.floors for pump in floor.pumps]
            if source.pump not in known:
                names = ", ".join(known) or "none"
                raise NotFound(
                    f"site {self.site.name} has no pump `{source.pump}`; there are: {names}"
                )
        self._active.append((source, now))

    def remove(self, source: Source, now: float = 0.0) -> None:
        """Remove a source at time `now` (s); of equal sources, the one that began first.

        Raises NotFound if there is no such source.
        """
        first = next((k for k, (active, _) in enumerate(self._active) if active == source), None)
        if first is None:
            raise NotFound(f"site {self.site.name} has no such source: {source}")
        _, start = self._active.pop(first)
        if isinstance(source, GasLeak):
            self._ended.append(Release(source, start, now))


@dataclass(frozen=True)
class RadioShadow:
    """Part of the site without a radio signal."""

    rect: Rect | None = None
    """m, [x0, y0, x1, y1]; None: not limited in x and y"""
    floor: int | None = None
    """number of the floor; None: all floors"""

    def contains(self, pose: BodyPose, site: Site) -> bool:
        """Return True if a robot at `pose` is in this part, and so has no radio signal."""
        if self.floor is not None and site.floor_at(pose.z) != self.floor:
            return False
        if self.rect is None:
            return True
        x0, y0, x1, y1 = self.rect
        return x0 <= pose.x <= x1 and y0 <= pose.y <= y1


class RadioNetwork:
    """Wireless network of a site, with the parts that have no signal at present."""

    def __init__(self, site: Site) -> None:
        self._site = site
        self.shadows: list[RadioShadow] = []

    def is_connected(self, pose: BodyPose) -> bool:
        """Return True if a robot at `pose` has a signal: it is in none of the shadows."""
        return not any(shadow.contains(pose, self._site) for shadow in self.shadows)
