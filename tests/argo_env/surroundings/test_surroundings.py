"""The surroundings hold the active sources, and gas that has escaped."""

import pytest

from argo_compiler.base.errors import ArgoError, NotFound
from argo_env.surroundings import Alarm, GasLeak, HotSpot, PumpSound, Surroundings
from argo_env.surroundings.surroundings import Release

LEAK = GasLeak((1, 2, 3))


def test_sources_come_and_go(umad):
    surroundings = Surroundings(umad)
    spot = HotSpot((0, 0, 1))
    surroundings.add(spot, 3.0)
    surroundings.add(Alarm(), 4.0)
    surroundings.add(spot, 9.0)
    assert surroundings.sources == (spot, Alarm(), spot)
    surroundings.remove(Alarm(), 5.0)
    surroundings.remove(spot, 5.5)
    assert surroundings.sources == (spot,)
    with pytest.raises(NotFound):
        surroundings.remove(Alarm(), 6.0)


def test_gas_stays_after_its_leak_is_closed(umad):
    surroundings = Surroundings(umad)
    surroundings.add(LEAK, 10.0)
    assert surroundings.releases == (Release(LEAK, 10.0),)
    surroundings.remove(LEAK, 20.0)
    surroundings.add(LEAK, 30.0)
    assert surroundings.releases == (Release(LEAK, 10.0, 20.0), Release(LEAK, 30.0))


def test_two_equal_leaks_add_up(umad):
    surroundings = Surroundings(umad)
    surroundings.add(LEAK, 10.0)
    surroundings.add(LEAK, 20.0)
    surroundings.remove(LEAK, 30.0)
    assert surroundings.sources == (LEAK,)
    surroundings.remove(LEAK, 40.0)
    assert surroundings.releases == (Release(LEAK, 10.0, 30.0), Release(LEAK, 20.0, 40.0))


def test_the_error_for_an_unknown_pump_names_the_pumps(umad):
    with pytest.raises(ArgoError, match="no pump `P-9`; there are: pump P-301, "):
        Surroundings(umad).add(PumpSound("P-9"))
