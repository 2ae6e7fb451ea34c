"""An all-clear is given only when no other danger goes on, or when it is the awaited one."""

import pytest

from argo_compiler.il import EventKind
from argo_env.faults.plant import GasLeakFault, PlatformAlarm
from argo_env.robot.pose import BodyPose
from argo_env.run.perception import Perception
from argo_env.sensing.watch import Detection
from tests.argo_env.faults.test_all_clear import run_with_leak

HERE = BodyPose(1.0, 1.0, 0.02, 0.0)
LEAK, ALARM, CLEAR = EventKind.GAS_LEAK, EventKind.PLATFORM_ALARM, EventKind.ALL_CLEAR
SPOT = EventKind.HOT_SPOT


class Scripted:
    """Watch that detects one kind of event after another, at given times (s)."""

    period = 1.0

    def __init__(self, name, detections):
        self.name = name
        self._detections = detections

    def update(self, now, _):
        kinds = self._detections.get(now, ())
        return tuple(Detection(kind, "") for kind in kinds)

    def restore(self, reported, now):
        """Do nothing."""


def all_clears(site, gas, alarm, reactions, restored=()):
    """Return time and source of each all-clear, with the reaction that begins at each time."""
    watches = (Scripted("gas", gas), Scripted("alarm", alarm))
    perception = Perception(watches, site, 1.0)
    perception.restore_anomalies([(anomaly, HERE) for anomaly in restored], 0.0)
    found = []
    for now in range(1, 31):
        perception.reaction = reactions.get(now, perception.reaction)
        found += perception.update(now, float(now), HERE)
    return [(a.t, a.source) for a in found if a.kind is CLEAR]


@pytest.mark.rule("R13")
@pytest.mark.parametrize(
    ("gas", "alarm", "reactions", "expected"),
    [
        ({2: [LEAK], 9: [CLEAR]}, {}, {}, [(9, "gas")]),
        ({}, {3: [ALARM], 9: [CLEAR]}, {}, [(9, "alarm")]),
        # The alarm ends first: nothing is said before the leak is over as well.
        ({2: [LEAK]}, {3: [ALARM], 9: [CLEAR]}, {}, []),
        ({2: [LEAK]}, {3: [ALARM], 9: [CLEAR]}, {2: LEAK}, []),
        ({2: [LEAK], 20: [CLEAR]}, {3: [ALARM], 9: [CLEAR]}, {}, [(20, "gas"), (20, "alarm")]),
        ({2: [LEAK], 9: [CLEAR]}, {3: [ALARM], 20: [CLEAR]}, {}, [(20, "alarm"), (21, "gas")]),
        # The mission reacts to the danger that is over.
        ({2: [LEAK]}, {3: [ALARM], 9: [CLEAR]}, {3: ALARM}, [(9, "alarm")]),
        ({2: [LEAK], 9: [CLEAR]}, {3: [ALARM]}, {2: LEAK}, [(9, "gas")]),
        # Its reaction to the alarm begins when that is over already.
        ({2: [LEAK]}, {3: [ALARM], 9: [CLEAR]}, {2: LEAK, 15: ALARM}, [(15, "alarm")]),
        # It reacts to something of which the robot does not sense the end.
        ({}, {3: [ALARM], 9: [CLEAR]}, {2: SPOT}, []),
        ({}, {3: [ALARM], 9: [CLEAR]}, {2: EventKind.LOW_BATTERY}, [(9, "alarm")]),
        # The alarm sounds again before its end was reported.
        ({2: [LEAK], 12: [CLEAR]}, {3: [ALARM], 9: [CLEAR], 11: [ALARM]}, {}, []),
    ],
)
def test_an_all_clear_is_given_for_all_that_was_found(yard, gas, alarm, reactions, expected):
    found = all_clears(yard.site, gas, alarm, reactions)
    assert found == expected


@pytest.mark.rule("R13")
def test_a_leak_that_was_found_before_the_run_was_resumed_goes_on(yard):
    perception = Perception((Scripted("gas", {1: [LEAK]}),), yard.site, 1.0)
    (leak,) = perception.update(1, 1.0, HERE)
    assert all_clears(yard.site, {}, {3: [ALARM], 9: [CLEAR]}, {}, restored=[leak]) == []


MISSION = """Maximum duration: 60 min
In case of a gas leak, pause until all clear for at most 5 minutes and resume.
1. Start in starting area 1.
2. Check checkpoint #5.
3. Return to the docking station in starting area 1.
"""


@pytest.mark.physics
@pytest.mark.rule("R13")
def test_the_end_of_an_alarm_does_not_end_the_wait_for_a_leak():
    leak = GasLeakFault(at=60.0, place=(8.0, 6.0, 3.3), rate=0.02)
    record = run_with_leak(MISSION, 2, (leak, PlatformAlarm(at=80.0, until=120.0)))
    assert [a.kind for a in record.anomalies] == [LEAK, ALARM]
    (wait,) = [i for i in record.interruptions if i.event is LEAK]
    assert wait.limit_over
