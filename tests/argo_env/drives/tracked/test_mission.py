"""A whole mission with the tracked drive."""

import pytest

from tests.yard import simulated


@pytest.mark.long
def test_mission_1_is_carried_out_without_a_contact(shipped, navigator):
    mission = shipped("mission_1.txt", start_area=1, end_area=2).mission
    record = simulated(mission, navigator, seed=3, drive="tracked")
    assert record.drive == "tracked"
    assert record.result.success, record.result.verdict
    assert record.result.docked
    assert record.contacts == ()
