"""Long computations report their stages to a listener."""

import pytest

from argo_compiler.base.stages import listen_to_stages, stage, stage_items


def test_a_stage_within_another_is_said_with_it_and_then_the_other_goes_on():
    reports = []
    with (
        listen_to_stages(lambda *stage_report: reports.append(stage_report)),
        stage("making the site") as report,
    ):
        for _ in stage_items("floors", [1, 2]):
            pass
        report(0.75, "nearly done")
    assert reports == [
        ("making the site", None, ""),
        ("making the site: floors", None, ""),
        ("making the site: floors", 0.0, ""),
        ("making the site: floors", 0.5, ""),
        ("making the site", None, ""),
        ("making the site", 0.75, "nearly done"),
        (None, None, ""),
    ]


def test_what_fails_is_over():
    reports = []
    with listen_to_stages(lambda *stage_report: reports.append(stage_report)):
        with pytest.raises(ValueError, match="no"), stage("trying"):
            raise ValueError("no")
        with listen_to_stages(None), stage("in private"):
            pass
    assert reports == [("trying", None, ""), (None, None, "")]
    with stage("unheard") as report:
        report(1.0)
    assert len(reports) == 2
