"""Runs with batches of steps: record and journal equal those of a run that goes step by step.

They are equal to the last bit.
"""

import random

import pytest

from argo_compiler.base.errors import Conflict
from argo_compiler.hfsm import Cancel, GiveBack, Occurred, Pause, Resume, TakeOver
from argo_compiler.il import (
    Action,
    EventKind,
    Group,
    Mission,
    Reaction,
    Response,
    Task,
    WaitRule,
)
from argo_env.faults.loading import decode_faults
from argo_env.planning.opening import open_site
from argo_env.run.observer import Observer
from argo_env.run.session import simulate
from argo_env.run.spec import RunConditions, RunSpec, logged_events
from tests.conftest import seeds
from tests.yard import in_order

SITE = open_site("umad")
PAPER_FAULTS = (
    "{kind: abnormal_value}",
    "{kind: displaced_checkpoint}",
    "{kind: low_battery}",
    "{kind: low_battery, charge: 0.005}",
    "{kind: worn_battery, capacity: 0.01}",
    "{kind: connection_loss, floor: 1, at: 20, until: 60}",
    "{kind: connection_loss}",
    "{kind: emergency_stop, at: 31.27, until: 52.1}",
    "{kind: emergency_stop, at: 40}",
    "{kind: sensor_dysfunction, effect: noise}",
    "{kind: sensor_dysfunction, effect: fails, at: 10, until: 70}",
    "{kind: drive_dysfunction, at: 12, until: 80}",
    "{kind: drive_dysfunction, speed: 0.0, at: 25}",
    "{kind: drive_dysfunction, speed: 0.013, at: 5, until: 45}",
)
WORLD_FAULTS = (
    "{kind: gas_leak, at: 15}",
    "{kind: platform_alarm, at: 20, until: 60}",
    "{kind: brick}",
    "{kind: missing_plate}",
)
EVENTS = (Occurred(EventKind.GAS_LEAK), Pause(), Resume(), TakeOver(), GiveBack(), Cancel())


class StepByStep(Observer):
    """Observer of single steps, which rules batches out."""

    def on_step(self, now, action):
        """Do nothing."""


def mission_of(chosen: random.Random) -> Mission:
    """Return a random mission of gauges, waypoints, waits and rounds, with reactions and limits."""
    gauges = [str(c.id) for c in SITE.site.checkpoints]
    docks = SITE.site.docks
    tasks = [("START", {"action": Action.START, "pose": docks[chosen.choice([1, 2])]})]
    for k in range(chosen.randint(1, 4)):
        match chosen.randrange(4):
            case 0:
                rule = WaitRule(duration=chosen.choice([0.05, 7.0, 33.3]))
                tasks.append((f"WAIT {k}", {"action": Action.WAIT, "wait": rule}))
            case 1:
                pose = docks[chosen.choice([1, 2])]
                speed = chosen.choice([None, 0.1, 0.45])
                more = {"action": Action.WAYPOINT, "pose": pose, "velocity": speed}
                tasks.append((f"GO {k}", more))
            case _:
                more = {"action": Action.MEASURE, "object_id": chosen.choice(gauges)}
                if chosen.random() < 0.2:
                    more["reading_limit"] = chosen.choice([1.0, 30.0])
                tasks.append((f"READ {k}", more))
    names = [name for name, _ in tasks]
    made = in_order(
        *(
            Task(name=name, group="Again" if k else "", **more)
            for k, (name, more) in enumerate(tasks)
        )
    )
    group = Group(name="Again", start=names[1], end=names[-1], max_repeat_count=2)
    reactions = [
        Reaction(event=EventKind.LOW_BATTERY, response=Response.RETURN),
        Reaction(event=EventKind.GAS_LEAK, response=Response.PAUSE),
        Reaction(event=EventKind.CONNECTION_LOST, response=Response.PAUSE),
    ]
    return Mission(
        tasks=made,
        groups=(group,),
        reactions=tuple(chosen.sample(reactions, chosen.randint(0, 3))),
        max_duration=chosen.choice([None, None, 120.0]),
        dock=docks[1],
    )


def spec_of(seed: int, drive: str = "route") -> RunSpec:
    chosen = random.Random(seed)
    possible = PAPER_FAULTS if drive == "route" else PAPER_FAULTS + WORLD_FAULTS
    faults = chosen.sample(possible, chosen.choice([0, 0, 1, 2, 3]))
    events = []
    for _ in range(chosen.choice([0, 0, 1, 3])):
        events.append((round(chosen.uniform(0, 120), 2), chosen.choice(EVENTS)))
    conditions = RunConditions(
        speed=chosen.choice([1.0, 1.0, 0.83, 0.5]),
        charge=chosen.choice([None, 0.21, 0.9]),
        sensor_noise=chosen.choice([0.0, 0.02]),
        turned=chosen.choice([0.0, 12.0]),
    )
    text = f"faults: [{', '.join(faults)}]" if faults else "faults: []"
    return RunSpec(
        mission=mission_of(chosen),
        drive=drive,
        seed=seed,
        faults=decode_faults(text.encode(), "test").faults,
        events=logged_events(*sorted(events, key=lambda timed: timed[0])),
        conditions=conditions,
    )


def outcome(spec, **options) -> str:
    """Return the record as a text, or the message of the event that was refused."""
    try:
        return simulate(spec, SITE, **options).model_dump_json()
    except Conflict as error:
        return str(error)


SEEDS = seeds(60)
CASES = [
    *(
        pytest.param(seed, "route", marks=pytest.mark.long if number >= 4 else ())
        for number, seed in enumerate(SEEDS)
    ),
    *(
        pytest.param(1000 + seed, "kinematic", marks=pytest.mark.long if number >= 1 else ())
        for number, seed in enumerate(SEEDS[: max(4, len(SEEDS) // 5)])
    ),
]


@pytest.mark.parametrize(("seed", "drive"), CASES)
def test_the_record_and_the_journal_are_those_of_step_by_step(seed, drive, tmp_path):
    spec = spec_of(seed, drive)
    slow = outcome(spec, observers=[StepByStep()], journal=tmp_path / "slow")
    assert outcome(spec) == slow
    assert outcome(spec, journal=tmp_path / "fast") == slow
    assert (tmp_path / "fast").read_bytes() == (tmp_path / "slow").read_bytes()
