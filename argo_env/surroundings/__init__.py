"""What surrounds the robot besides solids: sources of gas, heat and sound, and their fields."""

from argo_env.surroundings.sources import Alarm, GasLeak, HotSpot, PumpFault, PumpSound, Source
from argo_env.surroundings.surroundings import Surroundings, Weather

__all__ = [
    "Alarm",
    "GasLeak",
    "HotSpot",
    "PumpFault",
    "PumpSound",
    "Source",
    "Surroundings",
    "Weather",
]
