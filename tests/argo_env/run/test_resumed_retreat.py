"""A run that dies where the robot is cornered: it goes on as if it had not died."""

import math

import pytest

from argo_env.faults.walkway import Brick
from argo_env.run.record import Anomaly
from tests.yard import Watching, from_place, measure, resumed, simulated

BRICK = Brick(floor=2, place=(12.2958, 5.05), yaw=22.05)
"""on the walkway behind the east tower: before it the robot has no room to turn"""


class KilledError(Exception):
    """The process is gone."""


def test_goes_back_along_the_way_that_it_came(navigator, tmp_path):
    plan = from_place(navigator.site.docks[1], measure(15))
    place = tmp_path / "run.journal"

    def die(news):
        if isinstance(news, Anomaly):
            raise KilledError

    with pytest.raises(KilledError):
        simulated(
            plan,
            navigator,
            seed=11,
            faults=(BRICK,),
            journal=place,
            observers=[Watching(announce=die)],
        )
    record = resumed(place, navigator)
    (found,) = record.anomalies
    assert record.resumed == (found.t,)
    assert record.result.success
    assert record.contacts == ()
    here, *after = [s for s in record.path if found.t <= s.t <= found.t + 5]
    straight = [s for s in after if abs(s.yaw - here.yaw) < 0.01]
    back = max((math.dist((s.x, s.y), (here.x, here.y)), s) for s in straight)[1]
    ahead = (back.x - here.x) * math.cos(here.yaw) + (back.y - here.y) * math.sin(here.yaw)
    assert ahead < -0.2
