"""The option `--event TIME=KIND`."""

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.hfsm import Cancel, GiveBack, Occurred, Pause, Resume, TakeOver
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import EventKind
from argo_planner.terminal.events import KINDS, parse_events


def test_events_come_in_the_order_of_time():
    assert parse_events(["60.5=pause", "3=gas_leak", "61=resume", "1e3=cancel"]) == [
        (3.0, Occurred(EventKind.GAS_LEAK)),
        (60.5, Pause()),
        (61.0, Resume()),
        (1000.0, Cancel()),
    ]
    assert parse_events([]) == []


@pytest.mark.parametrize("kind", [k for k in EventKind if k is not EventKind.TIME_UP])
def test_every_kind(kind):
    assert parse_events([f"0={kind}"]) == [(0.0, Occurred(kind))]


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("gas_leak", "write TIME=KIND"),
        ("60", "write TIME=KIND"),
        ("=gas_leak", "write TIME=KIND"),
        ("-1=gas_leak", "write TIME=KIND"),
        ("nan=gas_leak", "write TIME=KIND"),
        ("inf=gas_leak", "write TIME=KIND"),
        ("60=", "no event ``; there are: gas_leak"),
        ("60=Gas leak", "no event `Gas leak`"),
        ("60=time_up", "occurs by itself"),
    ],
)
def test_wrong_events_are_refused(option, says):
    with pytest.raises(ArgoError, match=says):
        parse_events(["1=hot_spot", option])


def test_the_help_lists_valid_kinds():
    for kind in KINDS.split(", "):
        parse_events([f"0={kind}"])


def test_takeovers_and_readings():
    assert parse_events(["5=take_over", "9=give_back", "7 = reading:8=4.2"]) == [
        (5.0, TakeOver()),
        (7.0, ReadingGiven("8", 4.2)),
        (9.0, GiveBack()),
    ]


@pytest.mark.parametrize("said", ["reading", "reading:8", "reading:=4", "reading:8=much"])
def test_a_reading_needs_an_id_and_a_value(said):
    with pytest.raises(ArgoError, match="reading:ID=VALUE"):
        parse_events([f"5={said}"])
