"""What the surroundings hold."""

import pytest

from argo_compiler.base.errors import ArgoError, NotFound
from argo_env.surroundings import Alarm, GasLeak, HotSpot, PumpSound, Surroundings
from argo_env.surroundings.surroundings import Release

LEAK = GasLeak((1, 2, 3))


def test_sources_come_and_go(umad):
    around = Surroundings(umad)
    spot = HotSpot((0, 0, 1))
    around.add(spot, 3.0)
    around.add(Alarm(), 4.0)
    around.add(spot, 9.0)
    assert around.sources == (spot, Alarm(), spot)
    around.remove(Alarm(), 5.0)
    around.remove(spot, 5.5)
    assert around.sources == (spot,)
    with pytest.raises(NotFound):
        around.remove(Alarm(), 6.0)


def test_gas_stays_after_its_leak_is_closed(umad):
    around = Surroundings(umad)
    around.add(LEAK, 10.0)
    assert around.releases == (Release(LEAK, 10.0),)
    around.remove(LEAK, 20.0)
    around.add(LEAK, 30.0)
    assert around.releases == (Release(LEAK, 10.0, 20.0), Release(LEAK, 30.0))


def test_two_equal_leaks_are_two(umad):
    around = Surroundings(umad)
    around.add(LEAK, 10.0)
    around.add(LEAK, 20.0)
    around.remove(LEAK, 30.0)
    assert around.sources == (LEAK,)
    around.remove(LEAK, 40.0)
    assert around.releases == (Release(LEAK, 10.0, 30.0), Release(LEAK, 20.0, 40.0))


def test_a_pump_that_is_not_there_is_refused_with_the_ones_that_are(umad):
    with pytest.raises(ArgoError, match="no pump `P-9`; there are: pump P-301, "):
        Surroundings(umad).add(PumpSound("P-9"))
