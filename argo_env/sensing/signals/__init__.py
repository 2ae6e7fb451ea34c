"""Watches for gas, heat, sound and terrain, with the instruments that they read."""

from argo_env.seeding import generator
from argo_env.sensing.signals.alarm_watch import AlarmWatch
from argo_env.sensing.signals.gas_watch import GasSensor, GasWatch, UltrasonicMicrophone
from argo_env.sensing.signals.heat_watch import HeatWatch, ThermalCamera
from argo_env.sensing.signals.microphone import Microphone
from argo_env.sensing.signals.pump_watch import PumpWatch
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.signals.terrain_watch import TerrainScanner, TerrainWatch
from argo_env.sensing.watch import Watch
from argo_env.surroundings import Surroundings
from argo_env.world.world import World


def standard_watches(world: World, surroundings: Surroundings, seed: int) -> tuple[Watch, ...]:
    """Return the watches for one run: gas, heat, pumps, the alarm and the terrain ahead.

    They sense what is in `surroundings` and in `world`; their map is the site of the
    `surroundings`, without what faults change. The seed draws their noise. Watches hold what they
    have sensed, so each run needs new ones.
    """
    site_map = SiteMap(surroundings.site)
    return (
        GasWatch(
            GasSensor(surroundings, generator(seed, "gas sensor")),
            UltrasonicMicrophone(surroundings, world, generator(seed, "ultrasonic microphone")),
            site_map,
        ),
        HeatWatch(
            ThermalCamera(surroundings, world, generator(seed, "thermal camera")),
            site_map,
            surroundings.weather.temperature,
        ),
        PumpWatch(Microphone(surroundings, generator(seed, "pumps")), surroundings.site),
        AlarmWatch(Microphone(surroundings, generator(seed, "alarm"))),
        TerrainWatch(TerrainScanner(world, site_map, generator(seed, "terrain scanner"))),
    )
