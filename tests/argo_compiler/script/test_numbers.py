"""Numbers, lengths of time, speeds and units in every way that people write them."""

from collections.abc import Callable

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import Mission
from argo_compiler.script.resolve.units import converted
from tests.whole_scripts import import_whole

START = "Start in starting area 1.\n"


def imported(text: str, catalog: Catalog) -> Mission:
    return import_whole(START + text, catalog).mission


def messages(text: str, catalog: Catalog) -> str:
    with pytest.raises(DiagnosticError) as raised:
        import_whole(START + text, catalog)
    return "\n".join(f"{d.message} {d.hint}" for d in raised.value.diagnostics)


def wait_s(mission: Mission) -> float:
    durations = [task.wait.duration for task in mission.tasks if task.wait is not None]
    assert len(durations) == 1
    assert durations[0] is not None
    return durations[0]


LENGTHS = {
    "90s": 90,
    "90 s": 90,
    "90 sec": 90,
    "20'": 1200,
    "20 min": 1200,
    "1 h 15": 4500,
    "1h15": 4500,
    "1h15min": 4500,
    "1 h 15 min": 4500,
    "1 hour and 15 minutes": 4500,
    "2min30s": 150,
    "1:30 h": 5400,
    "1:30 min": 90,
    "1:05:00 h": 3900,
    "00:12:30": 750,
    "90:00": 5400,
    "half an hour": 1800,
    "an hour": 3600,
    "an hour and a half": 5400,
    "one and a half hours": 5400,
    "two and a half hours": 9000,
    "1.5 h": 5400,
    "1,5 h": 5400,
    "1½ h": 5400,
    "a quarter of an hour": 900,
    "three quarters of an hour": 2700,
    "three quarter-hours": 2700,
    "eight minutes": 480,
    "twenty-five seconds": 25,
    "twenty five seconds": 25,
    "a dozen minutes": 720,
    "a hundred and five seconds": 105,
    "twelve hundred seconds": 1200,
    "nine thousand nine hundred ninety-nine seconds": 9999,
    "1.000,5 s": 1000.5,
    "1,000.5 s": 1000.5,
    "1'200 s": 1200,
    "1.000.000 s": 1_000_000,
    "25 min": 1500,
    "1 h 30 min": 5400,
    "1 hour and 30 minutes": 5400,
    "ninety seconds": 90,
    "a minute": 60,
    "2.5 h": 9000,
    "754.5 s": 754.5,
    "20′": 1200,
    "20min.": 1200,
    "twenty minutes": 1200,
    "two hours 5 seconds": 7205,
}


@pytest.mark.parametrize(("said", "seconds"), LENGTHS.items())
def test_lengths_of_time(said: str, seconds: float, catalog: Catalog) -> None:
    """Durations of a wait, of rounds, and of the whole mission are read alike."""
    mission = imported(f"Wait for {said}, then check checkpoint 3.", catalog)
    assert wait_s(mission) == pytest.approx(seconds)
    text = f"Maximum mission total duration: {said}\n{START}Patrol floor 1 for {said}"
    result = import_whole(text, catalog)
    assert result.diagnostics == ()
    (group,) = result.mission.groups
    assert group.max_repeat_duration == result.mission.max_duration == pytest.approx(seconds)


ASKED = {
    "1.200 s": ("1.2 s", "1200 s"),
    "1,200 s": ("1.2 s", "1200 s"),
    "1.200 minutes": ("1.2 min", "1200 min"),
    "2.500 hours": ("2.5 h", "2500 h"),
    "12:30": ("12 min 30 s", "12 h 30 min"),
}


@pytest.mark.parametrize(("said", "readings"), ASKED.items())
def test_two_readings_are_asked_about(
    said: str, readings: tuple[str, str], catalog: Catalog
) -> None:
    message = messages(f"Wait {said}, then check checkpoint 3.", catalog)
    assert f"`{said}` can be read as {readings[0]} or as {readings[1]}" in message


@pytest.mark.parametrize("reading", [r for both in ASKED.values() for r in both])
def test_what_is_asked_back_can_be_written(reading: str, catalog: Catalog) -> None:
    assert imported(f"Wait {reading}, then check checkpoint 3.", catalog).tasks


@pytest.mark.parametrize(
    "said",
    [
        *("minutes", "hours", "h", "min", "s"),
        *("1.2.3 s", "1,2,3 s", "12,34.5 s", "1.20,000 s", "0 s"),
    ],
)
def test_what_is_no_length_of_time_is_an_error(said: str, catalog: Catalog) -> None:
    assert messages(f"Wait {said}, then check checkpoint 3.", catalog)


BOUNDS = {
    "4,5": 4.5,
    "4.5": 4.5,
    "4,5 bar": 4.5,
    "4.5bar": 4.5,
    "4500 mbar": 4.5,
    "0.45 MPa": 4.5,
    "450 kPa": 4.5,
    "4500 hPa": 4.5,
    "450000 pascals": 4.5,
    "four bar": 4,
}


@pytest.mark.parametrize(("said", "bound"), BOUNDS.items())
def test_amounts_in_the_unit_of_the_gauge(
    said: str, bound: float, meaning_of: Callable[[str], object]
) -> None:
    text = f"{START}Check checkpoint 1. If it is above {said}, check checkpoint 4."
    plain = f"{START}Check checkpoint 1. If it is above {bound:g}, check checkpoint 4."
    assert meaning_of(text) == meaning_of(plain)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("1.200 bar", "can be read as 1.2 bar or as 1200 bar"),
        *(
            (said, "pressure gauge 1 (#1) is measured in bar")
            for said in ("3 °C", "20 %", "2 m", "5 kg", "4 degrees", "3 litres")
        ),
    ],
)
def test_amounts_that_do_not_fit_the_gauge(said: str, told: str, catalog: Catalog) -> None:
    text = f"Check checkpoint 1. If it is above {said}, check checkpoint 4."
    assert told in messages(text, catalog)


def test_a_share_is_no_angle(catalog: Catalog) -> None:
    text = "Check checkpoint 4. If it is above 30 %, check checkpoint 5."
    assert "valve R25 (#4) is measured in deg" in messages(text, catalog)
    assert converted(30, "%", "deg") is None
    assert converted(1, "rad", "deg") == pytest.approx(57.2957795131)


@pytest.mark.parametrize("unit", ["l/(", "bar*", "", "a b", "1/0", "furlongs of rope"])
def test_units_that_are_none_are_not_converted(unit: str) -> None:
    assert converted(3, "bar", unit) is None


SPEEDS = {"0.3 m/s": 0.3, "0,3 m/s": 0.3, "1.08 km/h": 0.3, "30 cm/s": 0.3, "0.3 m / s": 0.3}
SPEEDS |= {"0.3 metres per second": 0.3, "half a metre": None}


@pytest.mark.parametrize(("said", "speed"), SPEEDS.items())
def test_speeds(said: str, speed: float | None, catalog: Catalog) -> None:
    text = f"Check checkpoint 3 at {said}."
    if speed is None:
        assert messages(text, catalog)
    else:
        assert imported(text, catalog).tasks[-1].velocity == speed


def test_which_one_of_several_is_not_dropped(catalog: Catalog) -> None:
    assert "understand `valve` here" in messages("Check the second valve.", catalog)
    first = imported("Check checkpoint 13 first, then checkpoint 4.", catalog)
    assert [task.object_id for task in first.tasks[1:]] == ["13", "4"]


@pytest.mark.parametrize(
    "bounds",
    ["above 5 and between 1 and 2", "below 1 and above 2", "at most 1 and between 2 and 3"],
)
def test_bounds_that_no_value_keeps_to_are_asked_about(bounds: str, catalog: Catalog) -> None:
    assert "no value satisfies" in messages(f"Check #1. If it is {bounds}, check #4.", catalog)


def test_of_what_is_not_between_two_bounds_the_other_side_is_left(catalog: Catalog) -> None:
    mission = imported("Check #1. If it is not between 1 and 2 and above 1.5, check #4.", catalog)
    ways = [t.conditions for task in mission.tasks for t in task.transitions if t.conditions]
    assert [[c.param1 for c in way] for way in ways] == [[2.0, 1.5]]
