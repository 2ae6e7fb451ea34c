"""All watches together: equal seeds give equal findings, and a clean plant gives none."""

from argo_compiler.il import EventKind
from argo_env.sensing.signals import standard_watches
from argo_env.surroundings import Alarm, GasLeak, HotSpot, PumpFault, PumpSound, Surroundings
from tests.argo_env.sensing.signals.plant import Z, lane, told


def run(site, world, seed, *sources):
    around = Surroundings(site)
    for source in sources:
        around.add(source)
    way = lane(0.5, 15.0, y=3.0)
    return [found for watch in standard_watches(world, around, seed) for found in told(watch, way)]


EVERYTHING = (
    GasLeak((6.0, 3.14, Z + 1.0)),
    HotSpot((12.0, 4.0, Z + 1.0)),
    PumpSound("pump P-1", PumpFault.CAVITATION),
    Alarm(),
)


def test_each_source_is_told_by_its_kind(site, world):
    kinds = {finding.kind for *_, finding in run(site, world, 1, *EVERYTHING)}
    assert kinds == {
        EventKind.GAS_LEAK,
        EventKind.HOT_SPOT,
        EventKind.ABNORMAL_SOUND,
        EventKind.PLATFORM_ALARM,
    }


def test_a_clean_plant_is_clean(site, world):
    assert [run(site, world, seed) for seed in range(3)] == [[], [], []]


def test_equal_seeds_give_equal_findings_and_one_source_does_not_change_another(site, world):
    once, again = (run(site, world, 7, *EVERYTHING) for _ in range(2))
    assert once == again
    spots = [f for f in once if f[2].kind is EventKind.HOT_SPOT]
    alone = run(site, world, 7, EVERYTHING[1])
    assert [f for f in alone if f[2].kind is EventKind.HOT_SPOT] == spots
