"""Random spread of travel times around those of a route problem."""

from pydantic import Field

from argo_compiler.base.model import Model


class TravelSpread(Model):
    """Parameters of the random parts of a mission, which are independent of each other.

    A leg, the drive to one location, takes nominal time x common factor x factor of its own, and
    sometimes a delay. Factors are log-normal with mean 1. The energy of a leg grows by the same two
    factors.
    """

    common: float = Field(0.0, ge=0, le=1)
    """standard deviation of the factor that all legs share: grip, the battery's voltage"""
    way: float = Field(0.0, ge=0, le=1)
    """standard deviation of the factor of each leg, drawn anew each time that it is driven"""
    delay_chance: float = Field(0.0, ge=0, le=1)
    """probability of a delay on each leg, by an obstacle"""
    delay: float = Field(0.0, ge=0)
    """mean of a delay, s; delays are exponential"""
    repeat_chance: float = Field(0.0, ge=0, le=1)
    """probability that a visit takes its service time twice: a measurement that is repeated"""
    source: str = ""
    """source of the numbers"""


SIMULATED = TravelSpread(
    common=0.001,
    way=0.007,
    source=(
        "the simulator with the tracked drive and no faults: missions on UMAD take 0.05 % more or "
        "less than planned in the median and 0.22 % at most (documentation, page `drives`), single "
        "motions of 5.6 s on average 0.2 s (calibration of the drive); a way is some 30 motions"
    ),
)

CAUTIOUS = TravelSpread(
    common=0.05,
    way=0.1,
    delay_chance=0.03,
    delay=45.0,
    repeat_chance=0.05,
    source="an assumption for a real site with people on it, not a measurement",
)
