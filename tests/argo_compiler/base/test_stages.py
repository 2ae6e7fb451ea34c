"""What takes long says what it does, and who listens hears it."""

import pytest

from argo_compiler.base.stages import each, heard_by, stage


def test_a_stage_within_another_is_said_with_it_and_then_the_other_goes_on():
    heard = []
    with heard_by(lambda *told: heard.append(told)), stage("making the site") as tell:
        for _ in each("floors", [1, 2]):
            pass
        tell(0.75, "nearly done")
    assert heard == [
        ("making the site", None, ""),
        ("making the site: floors", None, ""),
        ("making the site: floors", 0.0, ""),
        ("making the site: floors", 0.5, ""),
        ("making the site", None, ""),
        ("making the site", 0.75, "nearly done"),
        (None, None, ""),
    ]


def test_what_fails_is_over():
    heard = []
    with heard_by(lambda *told: heard.append(told)):
        with pytest.raises(ValueError, match="no"), stage("trying"):
            raise ValueError("no")
        with heard_by(None), stage("in private"):
            pass
    assert heard == [("trying", None, ""), (None, None, "")]
    with stage("unheard") as tell:
        tell(1.0)
    assert len(heard) == 2
