"""How free the order is, what comes before what, what matters most, and a battery's level."""

import pytest

from argo_compiler.il import EventKind, Order
from tests.argo_compiler.script.conftest import refusals
from tests.whole_scripts import import_whole


def read(catalog, *lines):
    return import_whole("\n".join(["Start in starting area 1.", *lines]), catalog)


def refused(catalog, *lines):
    errors = refusals("\n".join(["Start in starting area 1.", *lines]), catalog)
    return {(d.code.removeprefix("script."), d.span.line) for d in errors}


class TestOrder:
    @pytest.mark.parametrize(
        "lines",
        [
            ["Check checkpoints 4, 8 and 1 in any order.", "Return to the docking station."],
            ["In whatever order is best, check checkpoints 4, 8 and 1."],
            ["Check checkpoint 4.", "Check checkpoint 8.", "The order does not matter."],
            ["1. Do the following in any order:", "   a) check checkpoint 4", "   b) valve R12"],
        ],
    )
    def test_it_is_free(self, catalog, lines):
        assert read(catalog, *lines).mission.order is Order.ANY

    def test_it_is_as_written_if_nothing_is_said(self, catalog):
        for said in ("", " in this order"):
            mission = read(catalog, f"Check checkpoints 4 and 8{said}.").mission
            assert (mission.order, mission.before) == (Order.PRECISE, ())

    def test_only_of_some(self, catalog):
        """What is not free keeps its place among the others."""
        lines = ["Check checkpoint 1.", "Check checkpoints 4 and 8 in any order.", "Check #2."]
        mission = read(catalog, *lines).mission
        assert mission.order is Order.ANY
        assert mission.before == (
            ("MEASURE 1", "MEASURE 4"),
            ("MEASURE 1", "MEASURE 8"),
            ("MEASURE 4", "MEASURE 2"),
            ("MEASURE 8", "MEASURE 2"),
        )

    def test_only_of_some_where_a_condition_stands(self, catalog):
        lines = ["Check #1. If it is above 5, check #7.", "Check #4 and #8 in any order."]
        found = read(catalog, *lines)
        assert found.mission.order is Order.PRECISE
        assert [d.code for d in found.diagnostics] == ["script.partly-free"]

    def test_what_keeps_its_order_among_what_is_free(self, catalog):
        lines = ["The order is free.", "Check checkpoint 1.", "Check #4, #8 and #2 in this order."]
        mission = read(catalog, *lines).mission
        assert mission.order is Order.ANY
        assert mission.before == (("MEASURE 4", "MEASURE 8"), ("MEASURE 8", "MEASURE 2"))

    def test_it_is_not_both(self, catalog):
        lines = ["Order: precise", "Check checkpoints 4 and 8 in any order."]
        assert {code for code, _ in refused(catalog, *lines)} == {"repeated-field"}


@pytest.mark.rule("M10")
class TestPrecedence:
    @pytest.mark.parametrize(
        "lines",
        [
            ["Order: any", "Check #4, #8 and #1.", "Checkpoint 4 has to be read before #1."],
            ["Checkpoint 4 must be read before #1.", "Check #4, #8 and #1 in any order."],
            ["Check #4, #8 and #1 in any order, but #4 before #1."],
            ["Check #4, #8 and #1 in any order.", "Checkpoint 1 has to be checked after #4."],
        ],
    )
    def test_a_pair(self, catalog, lines):
        mission = read(catalog, *lines).mission
        assert (mission.order, mission.before) == (Order.ANY, (("MEASURE 4", "MEASURE 1"),))

    def test_a_pair_with_what_was_left_out(self, catalog):
        lines = ['Left out: "MEASURE 8"', "1. Check #4."]
        mission = read(catalog, *lines, '2. Always do step "MEASURE 8" before step 1.').mission
        assert mission.before == (("MEASURE 8", "MEASURE 4"),)
        refusal = {("not-planned", 4)}
        assert refused(catalog, *lines, "2. Always do step 1 before step 2.") == refusal

    def test_a_precise_order_has_to_keep_to_it(self, catalog):
        pair = "Checkpoint 8 has to be read before checkpoint 4."
        mission = read(catalog, "Check #8 and #4.", pair).mission
        assert mission.before == (("MEASURE 8", "MEASURE 4"),)
        assert refused(catalog, "Check #4 and #8.", pair) == {("precedence", 3)}

    def test_a_free_order_that_does_not_keep_to_it_yet_is_a_warning(self, catalog):
        pair = "Checkpoint 8 has to be read before checkpoint 4."
        found = read(catalog, "Check #4 and #8 in any order.", pair)
        assert [d.code for d in found.diagnostics] == ["script.precedence"]

    @pytest.mark.parametrize(
        ("lines", "code"),
        [
            (["Check #4 and #8.", "#1 has to be read before #8."], "not-planned"),
            (["Check #4, #8 and #4.", "#4 has to be read before #8."], "ambiguous-edit"),
            (
                ["Check #4 and #8.", "#4 has to be read before #8.", "#8 must be read before #4."],
                "precedence",
            ),
        ],
    )
    def test_what_is_no_pair(self, catalog, lines, code):
        assert code in {found for found, _ in refused(catalog, *lines)}


class TestImportance:
    def test_in_words(self, catalog):
        lines = ["Check #4 with high priority.", "Check #8 with medium priority.", "Check #1."]
        found = read(catalog, *lines, "With priority low.")
        assert [t.priority for t in found.mission.tasks[1:]] == [3, 2, 1]
        assert [d.code for d in found.diagnostics] == ["script.priority-taken"] * 3

    @pytest.mark.parametrize(
        "line",
        [
            "Check checkpoints 4, 8 and 1, the most important first.",
            "By importance: checkpoints 4, 8, then 1.",
            "Check checkpoints 4, 8 and 1 in order of importance.",
        ],
    )
    def test_by_importance(self, catalog, line):
        found = read(catalog, line)
        got = [(t.object_id, t.priority) for t in found.mission.tasks[1:]]
        assert got == [("4", 3), ("8", 2), ("1", 1)]
        assert [d.code for d in found.diagnostics] == ["script.priority-taken"]

    def test_nothing_is_more_important_than_nothing(self, catalog):
        assert refused(catalog, "Check #4 by importance.") == {("stray-clause", 2)}
        assert refused(catalog, "Check #4 with priority 0.") == {("number", 2)}
        twice = "Check #4 with high priority and with priority 7."
        assert refused(catalog, twice) == {("repeated-limit", 2)}

    def test_what_does_not_fit_is_left_out(self, catalog):
        mission = read(catalog, "Check #4 and #8.", "Leave out what does not fit.").mission
        assert mission.order is Order.ANY
        assert [t.optional for t in mission.tasks] == [False, True, True]
        mission = read(
            catalog, "Order: precise", "Check #4.", "Leave out what does not fit."
        ).mission
        assert (mission.order, mission.tasks[1].optional) == (Order.PRECISE, True)


@pytest.mark.rule("R11")
class TestBattery:
    @pytest.mark.parametrize(
        "condition",
        ["the battery drops below 30 %", "the battery is below 30 percent", "the battery < 30%"],
    )
    def test_a_level(self, catalog, condition):
        lines = [f"If {condition}, return, recharge and go on.", "Check checkpoint 4."]
        (reaction,) = read(catalog, *lines).mission.reactions
        assert (reaction.event, reaction.battery_below) == (EventKind.LOW_BATTERY, 0.3)
        assert reaction.until is EventKind.BATTERY_CHARGED

    def test_without_one_the_robot_decides(self, catalog):
        lines = ["If the battery is low, pause.", "Check checkpoint 4."]
        assert read(catalog, *lines).mission.reactions[0].battery_below is None

    @pytest.mark.parametrize(
        "condition",
        [
            "the battery is below 130 %",
            "the battery is below 0 %",
            "the battery is below 5 bar",
            "the battery is below 30",
            "the battery rises above 30 %",
        ],
    )
    def test_what_is_no_level(self, catalog, condition):
        assert refused(catalog, f"If {condition}, pause.", "Check #4.") == {("battery", 2)}
