"""Specs made in code of arbitrary values: a run returns a record or raises an ArgoError."""

import math
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.hfsm import Cancel, GiveBack, Occurred, Pause, Resume, TakeOver
from argo_compiler.il import Mission, Task, Transition
from argo_env.faults.kinds import (
    AbnormalValue,
    ConnectionLoss,
    DriveDysfunction,
    EmergencyStop,
    LowBattery,
    SensorDysfunction,
)
from argo_env.planning.opening import open_site
from argo_env.run.record import RunRecord
from argo_env.run.session import run
from argo_env.run.spec import RunSpec, logged_events
from tests.conftest import examples

ONE = Mission(tasks=(Task(name="A", action="MEASURE", object_id="1"),))
SPEC = RunSpec(mission=ONE, site="darmstadt", drive="route")


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("mission", None),
        ("mission", 3),
        ("site", None),
        ("site", Path("site.yaml")),
        ("drive", ["route"]),
        ("sensor", None),
        ("seed", -1),
        ("seed", "x"),
        ("seed", math.nan),
        ("values", None),
        ("values", {1: math.nan}),
        ("values", {"gauge": 1.0}),
        ("events", None),
        ("events", ((1.0, "pause"),)),
        ("events", ((math.nan, logged_events((1.0, Pause()))[0][1]),)),
        ("faults", None),
        ("faults", ("fire",)),
        ("source", 3),
        ("reordering", 3),
    ],
)
def test_what_pydantic_has_not_looked_at_is_refused_with_the_name_of_the_field(field, value):
    with pytest.raises(Invalid, match=rf"the run's spec: {field}"):
        run(SPEC.model_copy(update={field: value}))
    with pytest.raises(Invalid, match="the run's spec: mission: `mission` is missing"):
        run(RunSpec.model_construct(**{field: value} if field != "mission" else {}))


@pytest.mark.parametrize("spec", [None, {}, "umad", ONE])
def test_what_is_no_spec(spec):
    with pytest.raises(Invalid, match="is not a spec of a run: make it a RunSpec"):
        run(spec)


@pytest.mark.parametrize("reference", [None, 3, b"umad", Path("site.yaml"), ["umad"]])
def test_what_names_no_site(reference):
    with pytest.raises(Invalid, match="is not text: a site is opened by its name"):
        open_site(reference)


NAMES = st.sampled_from(["A", "B", "C", "nowhere"])
NUMBERS = st.one_of(
    st.sampled_from([0, -1, 1, 5, 10, math.nan, math.inf, 1e300, 1e-300]), st.floats(0, 60)
)
AREAS = st.sampled_from([None, 1, 2, 0, 99])
TASKS = st.builds(
    dict,
    name=NAMES,
    action=st.sampled_from(["START", "MEASURE", "WAYPOINT"]),
    object_id=st.sampled_from([None, "1", "2", "5", "99", "", "one"]),
    transitions=st.lists(NAMES.map(lambda name: Transition(target=name)), max_size=2).map(tuple),
)
MISSIONS = st.builds(
    dict,
    tasks=st.lists(TASKS, max_size=3),
    site=st.sampled_from(["", "darmstadt", "umad"]),
    max_duration=st.one_of(st.none(), NUMBERS),
    start_area=AREAS,
    end_area=AREAS,
)
EVENTS = st.sampled_from(
    [Pause(), Resume(), TakeOver(), GiveBack(), Cancel(), Occurred("gas_leak"), Occurred("time_up")]
)
FAULTS = st.one_of(
    st.builds(
        dict,
        kind=st.sampled_from([LowBattery, ConnectionLoss, EmergencyStop, DriveDysfunction]),
        at=NUMBERS,
    ),
    st.builds(
        dict,
        kind=st.sampled_from([AbnormalValue, SensorDysfunction]),
        checkpoint=st.sampled_from([1, 2, 99, -1]),
    ),
)
# Most fields of most specs are sound, or none would get beyond the first check.
SPECS = st.fixed_dictionaries(
    {"mission": st.one_of(st.just(ONE.model_dump()), MISSIONS)},
    optional={
        "drive": st.sampled_from(["route", "route", "route", "", "rocket"]),
        "sensor": st.sampled_from(["ideal", "ideal", "camera", "nose"]),
        "seed": st.one_of(st.integers(-1, 2**70), NUMBERS),
        "values": st.dictionaries(st.sampled_from([1, 2, 99, -1]), NUMBERS, max_size=2),
        "events": st.lists(st.tuples(NUMBERS, EVENTS), max_size=2),
        "faults": st.lists(FAULTS, max_size=2),
        "source": st.sampled_from([None, "", "no/such/file", "a\0b", "."]),
    },
)


@settings(max_examples=examples(150))
@given(SPECS)
def test_a_run_of_any_spec_gives_a_record_or_is_refused(fields):
    try:
        faults = tuple(
            fault["kind"](**{k: v for k, v in fault.items() if k != "kind"})
            for fault in fields.get("faults", ())
        )
        events = logged_events(*fields.get("events", ()))
        spec = RunSpec(
            **{"drive": "route"} | fields | {"faults": faults, "events": events},
            site="darmstadt",
        )
    except (ValidationError, ArgoError):
        return
    with suppress(ArgoError):
        assert isinstance(run(spec), RunRecord)
