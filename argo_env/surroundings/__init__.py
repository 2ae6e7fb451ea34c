"""Surroundings of the robot apart from solids: sources of gas, heat and sound, and their fields."""

from argo_env.surroundings.surroundings import (
    Alarm,
    GasLeak,
    HotSpot,
    PumpFault,
    PumpSound,
    Source,
    Surroundings,
    Weather,
)

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
