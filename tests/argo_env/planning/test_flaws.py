"""Flaws of a site are reported with their positions and remedies."""

import copy

import numpy as np
import pytest

from argo_env.navigation import Navigator
from argo_env.planning.flaws import find_flaws
from argo_env.planning.flaws.site_check import _find_hiding_element
from argo_env.robot.spec import load_robot
from argo_env.site import make_site
from argo_env.site.spec import SiteSpec

RISE = 2.5 / 14
YARD = {
    "name": "yard",
    "title": "Yard",
    "storey": 2.5,
    "ground": [-2.5, -0.5, 9.5, 4.6],
    "ground_z": -0.03,
    "floors": [
        {
            "number": 1,
            "z": 0.0,
            "railed": False,
            "walkways": {"slab": [0, 0, 9, 4.5]},
            "checkpoints": [
                {
                    "id": 1,
                    "kind": "pressure gauge",
                    "name": "gauge 1",
                    "position": [3, 4.2, 1.2],
                    "yaw": -90,
                    "nominal": {"low": 3, "high": 5},
                }
            ],
        },
        {"number": 2, "z": 2.5, "walkways": {"platform": [5.14, 0.6, 8.9, 4.3]}},
    ],
    "towers": [
        {
            "name": "stairs",
            "flights": [
                {
                    "name": "flight",
                    "foot": [1.5, 1.55, 0],
                    "yaw": 0,
                    "risers": 14,
                    "rise": RISE,
                    "going": 0.28,
                    "width": 0.9,
                }
            ],
        }
    ],
    "areas": [{"number": 1, "dock": [-1.2, 2.5, 180]}],
}


def flaws(change):
    site = copy.deepcopy(YARD)
    change(site)
    spec = SiteSpec.model_validate(site)
    return find_flaws(Navigator(make_site(spec), load_robot())).flaws


def flight(site):
    return site["towers"][0]["flights"][0]


def checkpoint(site):
    return site["floors"][0]["checkpoints"][0]


def l_shaped(site):
    site["floors"][1]["walkways"] = {
        "platform": [5.14, 0.6, 6.9, 2.4],
        "arm": [6.9, 1.0, 8.8, 1.8],
        "end": [8.0, 1.8, 8.8, 4.3],
    }


def behind_a_tank(site):
    tank = {"name": "tank T-1", "axis": "z", "center": [3, 3.5, 1], "radius": 0.6, "length": 2}
    site["floors"][0]["vessels"] = [tank]


def behind_two_tanks(site):
    site["floors"][0]["vessels"] = [
        {"name": f"tank T-{k}", "axis": "z", "center": [x, 3.6, 1], "radius": 0.5, "length": 2}
        for k, x in enumerate([2.5, 3.5], 1)
    ]


def fenced_off(site):
    site["areas"].append({"number": 2, "dock": [7.5, 3, 0]})
    site["floors"][0]["barriers"] = {
        "fence": [[5.5, 1], [8.8, 1], [8.8, 4.3], [5.5, 4.3], [5.5, 1]]
    }


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            lambda site: site.update(towers=[]),
            "floor 2 can't be reached from docking station 1: there are no stairs; give `towers`",
        ),
        (
            lambda site: site["floors"][1]["walkways"].update(platform=[6.2, 0.6, 9.4, 4.3]),
            "floor 2 can't be reached from docking station 1: stairs: its flight `flight` ends in "
            "the air, at (5.14, 1.55), 1.06 m from `platform` of floor 2",
        ),
        (
            lambda site: site["floors"][0]["walkways"].update(slab=[2.5, 0, 9, 4.5]),
            "its flight `flight` begins in the air, at (1.50, 1.55), 1.00 m from `slab` of floor 1",
        ),
        (
            lambda site: site["floors"][0].update(
                barriers={"fence": [[2.2, 0.8], [0.8, 0.8], [0.8, 2.4], [2.2, 2.4]]}
            ),
            "its foot at (1.50, 1.55) can't be driven up; the nearest position that can be reached "
            "is",
        ),
        (
            lambda site: flight(site).update(width=0.5),
            "its flight `flight` is 0.5 m wide; make it 0.7 m at least",
        ),
        (
            lambda site: site["floors"][1]["walkways"].update(platform=[5.14, 0.6, 8.9, 2.4]),
            "floor 2 can be reached, but not patrolled: that takes three positions to "
            "turn at, 2 m apart, and there are",
        ),
        (
            l_shaped,
            "too narrow, or not free: the south-east corner, (8.80, 1.00), where `arm` is 0.80 m",
        ),
        (
            lambda site: site["floors"][0].update(railed=True),
            "floor 1 railing 1; leave the railing out where the path leads in (`gates`), or give "
            "`railed: false`; floor 2 can't be reached either",
        ),
        (
            lambda site: site.update(ground_z=-0.4),
            "it lies 0.40 m above the ground, and the robot climbs steps of 0.2 m",
        ),
        (behind_a_tank, "its face looks south (`yaw` -90), and tank T-1 hides it from each of the"),
        (behind_two_tanks, "any of the 504 poses before it; tank T-2 hides it from some; turn"),
        (
            lambda site: checkpoint(site).update(yaw=90, position=[3, 4.4, 1.2]),
            "its face looks north (`yaw` 90), and there is nowhere to stand 0.3 to 2 m from it",
        ),
        (
            lambda site: site.update(places=[{"name": "gate", "pose": [-9, 4, 0]}]),
            "place gate: there is no place that the robot can reach within 0.5 m of (-9.00, 4.00",
        ),
        (
            lambda site: site["areas"][0].update(dock=[-8, 2.5, 180]),
            "docking station 1: the robot can't stand at its `dock`, (-8.00, 2.50): that is "
            "outside of the ground, [-2.5, -0.5, 9.5, 4.6]",
        ),
        (
            lambda site: site["areas"][0].update(dock=[-2.3, 2.5, 180]),
            "docking station 1: the robot can't get away from its `dock`, (-2.30, 2.50)",
        ),
        (
            fenced_off,
            "there is no path from docking station 1 to docking station 2 and back: the nearest "
            "position that can be reached is (",
        ),
    ],
)  # fmt: skip
def test_a_flaw_is_said_with_its_place_and_a_way_out(change, says):
    found = flaws(change)
    assert any(says in flaw.message for flaw in found), [flaw.message for flaw in found]
    assert all(flaw.marks for flaw in found)


def test_a_site_in_order_has_none():
    assert flaws(lambda _: None) == ()


def test_what_follows_from_another_flaw_is_one_line():
    """Missing stairs are one flaw, which is not repeated for all that they make unreachable."""

    def change(site):
        site["floors"].append(copy.deepcopy(site["floors"][1]) | {"number": 3, "z": 5.0})
        for floor in (1, 2):
            seen = checkpoint(site) | {"id": 5 + floor, "position": [7, 3.9, 1.2], "yaw": -90}
            site["floors"][floor]["checkpoints"] = [seen]
        site["towers"] = []

    reached, *unread = [flaw.message for flaw in flaws(change)]
    assert reached.endswith("; floor 3 can't be reached either")
    assert unread == [
        "checkpoint 6 on floor 2 can't be read, as it can't be reached",
        "checkpoint 7 on floor 3 can't be read, as it can't be reached",
    ]


def test_no_element_is_named_where_none_hides():
    site = make_site(SiteSpec.model_validate(YARD))
    cameras = np.array([[3.0, y, 0.6] for y in (2.5, 3.0, 3.5)])
    assert _find_hiding_element(site, cameras, (3.0, 4.1, 1.2)) is None
