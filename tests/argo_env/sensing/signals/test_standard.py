"""All watches together: equal seeds give equal detections, and a clean plant gives none."""

import pytest

from argo_compiler.il import EventKind
from argo_env.sensing.signals import standard_watches
from argo_env.surroundings import Alarm, GasLeak, HotSpot, PumpFault, PumpSound, Surroundings
from tests.argo_env.sensing.signals.plant import Z, detections_along, lane

pytestmark = pytest.mark.physics


def detect(site, world, seed, *sources):
    surroundings = Surroundings(site)
    for source in sources:
        surroundings.add(source)
    poses = lane(0.5, 15.0, y=3.0)
    return [
        detection
        for watch in standard_watches(world, surroundings, seed)
        for detection in detections_along(watch, poses)
    ]


EVERYTHING = (
    GasLeak((6.0, 3.14, Z + 1.0)),
    HotSpot((12.0, 4.0, Z + 1.0)),
    PumpSound("pump P-1", PumpFault.CAVITATION),
    Alarm(),
)


def test_each_source_is_reported_by_its_kind(site, world):
    kinds = {detection.kind for *_, detection in detect(site, world, 1, *EVERYTHING)}
    assert kinds == {
        EventKind.GAS_LEAK,
        EventKind.HOT_SPOT,
        EventKind.ABNORMAL_SOUND,
        EventKind.PLATFORM_ALARM,
    }


def test_a_clean_plant_is_clean(site, world):
    assert [detect(site, world, seed) for seed in range(3)] == [[], [], []]


def test_equal_seeds_give_equal_findings_and_one_source_does_not_change_another(site, world):
    first, again = (detect(site, world, 7, *EVERYTHING) for _ in range(2))
    assert first == again
    spots = [f for f in first if f[2].kind is EventKind.HOT_SPOT]
    alone = detect(site, world, 7, EVERYTHING[1])
    assert [f for f in alone if f[2].kind is EventKind.HOT_SPOT] == spots
