"""Diagnostics of the analysis on the charging of a low battery."""

import pytest

from argo_compiler.analysis import analyse
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.il import Afterwards, EventKind, Mission, Reaction, Response
from tests.argo_compiler.analysis.building import ConstantTravel, mission
from tests.mission_writing import drive, wait

CATALOG = Catalog(site="s", checkpoints=(), floors=(), areas=())
CHARGED = EventKind.BATTERY_CHARGED
RESUME = Afterwards.RESUME


class ChargingTravel(ConstantTravel):
    """Travel of a robot whose battery of 100 Wh is charged by 1 % in 36 s."""

    charging_power = 100.0


def findings(limit=None, travel=None, **fields):
    reaction = Reaction(
        **{
            "event": EventKind.LOW_BATTERY,
            "response": Response.RETURN,
            "until": CHARGED,
            "afterwards": RESUME,
            **fields,
        }
    )
    plan = mission("A", reactions=(reaction,), dock=Pose(x=0, y=0, z=0), max_duration=limit)
    found = analyse(plan, CATALOG, travel or ChargingTravel())
    return [d for d in found.diagnostics if "charg" in d.code]


@pytest.mark.parametrize(
    ("fields", "limit", "exceeds"),
    [
        ({}, 2807, True),  # 78 % of the battery: an estimate is wrong by 1 % at most
        ({}, 2809, False),
        ({"charge_to": 0.6}, 1403, True),
        ({"charge_to": 0.6}, 1405, False),
        ({"battery_below": 0.5}, 1727, True),
        ({"battery_below": 0.5}, 1729, False),
        ({"charge_for": 600}, 599, True),
        ({"charge_for": 600}, 601, False),
        ({"charge_to": 0.3, "charge_for": 600}, 599, True),
        ({"until": EventKind.ALL_CLEAR}, 60, False),
        ({"response": Response.PAUSE}, 60, False),
        ({}, None, False),
    ],
)
def test_charging_that_takes_longer_than_the_mission_may(fields, limit, exceeds):
    codes = [d.code for d in findings(limit, **fields)]
    assert ("analysis.charging-too-long" in codes) == exceeds


def test_the_level_or_the_time_that_takes_too_long_is_named():
    (level,) = findings(60, charge_to=0.6, charge_for=600)
    assert "charges the battery from 20% to 60%, which takes at least 23 min 24 s" in level.message
    (time,) = findings(60, charge_to=0.3, charge_for=600)
    assert "charges the battery for at least 10 min, longer than" in time.message
    assert time.hint == "recharge for a shorter time, or allow more time"


@pytest.mark.parametrize(
    ("fields", "cut_short"),
    [
        ({"hold_limit": 2807, "on_limit": RESUME}, True),
        ({"hold_limit": 2809, "on_limit": RESUME}, False),
        ({"hold_limit": 60, "on_limit": RESUME, "charge_to": 0.6}, True),
        ({"hold_limit": 60, "on_limit": Afterwards.WAIT}, False),
        ({"hold_limit": 60, "on_limit": Afterwards.END}, False),
    ],
)
def test_charging_that_a_limit_cuts_short(fields, cut_short):
    found = findings(**fields)
    assert [d.code for d in found] == ["analysis.charge-cut-short"] * cut_short


def test_the_charge_after_a_charging_that_is_cut_short_is_an_upper_bound():
    (finding,) = findings(hold_limit=65, on_limit=RESUME)
    assert "a charge of at most 22%, not 99%" in finding.message
    assert "at least 46 min 48 s to charge from 20%" in finding.message


AWAY = Pose(x=5, y=0, z=0)
AT_DOCK = Pose(x=0, y=0, z=0)


@pytest.mark.parametrize(
    ("fields", "code"),
    [
        ({"response": Response.PAUSE}, "charge-elsewhere"),
        ({"response": Response.PAUSE, "hold_limit": 60}, "charge-elsewhere"),
        ({"response": Response.SAFE_AREA, "pose": AWAY}, "charge-elsewhere"),
        ({"response": Response.SAFE_AREA, "pose": AT_DOCK}, None),
        ({"pose": AWAY}, "charge-elsewhere"),
        ({"event": EventKind.GAS_LEAK, "response": Response.PAUSE}, "charge-elsewhere"),
        ({"response": Response.PAUSE, "until": EventKind.ALL_CLEAR}, None),
        ({"until": None}, "not-charged"),
        ({"until": None, "afterwards": Afterwards.END}, None),
        ({"charge_to": 0.2}, "charge-too-low"),
        ({"charge_to": 0.21}, None),
        ({"charge_to": 0.2, "battery_below": 0.1}, None),
        ({}, None),
    ],
)
def test_a_reaction_that_leaves_the_battery_low(fields, code):
    found = [d.code for d in findings(**fields)]
    assert found == ([] if code is None else [f"analysis.{code}"])


@pytest.mark.parametrize(("x", "elsewhere"), [(0, False), (5, True)])
def test_a_step_that_waits_for_a_charge_where_nothing_charges(x, elsewhere):
    tasks = (drive("A", "W", pose=Pose(x=x, y=0, z=0)), wait("W", event=CHARGED, limit=9))
    plan = Mission(tasks=tasks, dock=AT_DOCK)
    found = analyse(plan, CATALOG, ChargingTravel()).diagnostics
    assert ("analysis.charge-elsewhere" in {d.code for d in found}) == elsewhere


def test_nothing_is_said_of_a_robot_whose_charging_is_unknown():
    assert findings(60, ConstantTravel()) == []
