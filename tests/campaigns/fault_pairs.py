"""Every finding has a cause: runs with two faults each, of all kinds in all pairs.

    python -m tests.campaigns.fault_pairs --runs 1000
    python -m tests.campaigns.fault_pairs --runs 1000 --drive route
    python -m tests.campaigns.fault_pairs --first 17 --runs 1

Each run has a number, from which all is drawn: the site, a short mission through one or two
checkpoints, whether it answers to what is found, and two faults, whose kinds go through all pairs,
either one first, that the drive can find. They begin and end around the moments at which the
undisturbed mission goes on to the next task: before, at and after them, and in between. Every
fourth run is cut off somewhere and resumed. What is found, told as over, failed at or given up must
have a cause among the two (tests/campaigns/fault_causes.py); what has none is printed with the line
that makes it again.
"""

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from multiprocessing import get_context
from typing import Any

import numpy as np
import yaml

from argo_compiler.hfsm import Executor, Resume, lower
from argo_compiler.il import Afterwards, EventKind, Mission, Reaction, Response
from argo_env.drives.kinematic import KinematicDrive
from argo_env.drives.timed_drive import RouteDrive
from argo_env.faults.kinds import KINDS, FaultFile, find_site_errors
from argo_env.planning import open_site
from argo_env.run.drives_and_sensors import DRIVES
from argo_env.run.log import Entry
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec, logged_events
from argo_env.seeding import generator
from benchmarks.options import parse_seed
from tests.campaigns.fault_causes import given_up_without_cause, without_cause
from tests.campaigns.faults import random_mission

MISSIONS = (
    *(("darmstadt", seed) for seed in (1, 2, 3, 10, 14, 22, 31)),
    ("generated:floors=2,size=12x12,stairs=straight,checkpoints=8,seed=1", 1),
    ("umad", 22),
)
"""sites, and seeds of random missions there that take one to two minutes"""
_STRIDE = 31  # has no divisor in common with the numbers of pairs
_OFF = (-1.0, -0.1, 0.0, 0.1, 1.0)  # s beside a moment at which a task ends
_SHORTLY = (0.3, 0.9, 1.9, 5.0, 20.0)  # s that a fault may last
_OPERATOR = (90.0, 150.0)  # s, when a person lets a mission go on that waits

REACTIONS = (
    Reaction(event=EventKind.EMERGENCY_STOP, response=Response.PAUSE, priority=5),
    Reaction(
        event=EventKind.PLATFORM_ALARM, response=Response.RETURN, until=EventKind.ALL_CLEAR,
        afterwards=Afterwards.RESUME, priority=4,
    ),
    Reaction(
        event=EventKind.GAS_LEAK, response=Response.RETURN, until=EventKind.ALL_CLEAR,
        afterwards=Afterwards.RESUME, priority=3,
    ),
    Reaction(event=EventKind.LOW_BATTERY, response=Response.RETURN, priority=2),
    Reaction(event=EventKind.DYSFUNCTION, response=Response.RETURN, priority=1),
    Reaction(
        event=EventKind.CONNECTION_LOST, response=Response.PAUSE,
        until=EventKind.CONNECTION_RESTORED,
    ),
)  # fmt: skip


@dataclass(frozen=True)
class FaultPair:
    """A run with two faults."""

    number: int
    spec: RunSpec
    resumed: float | None
    """where it is cut off and resumed, as a share of it; None: it is not"""

    def __str__(self) -> str:
        faults = [f.model_dump(mode="json", exclude_none=True) for f in self.spec.faults]
        return (
            f"python -m tests.campaigns.fault_pairs --first {self.number} --runs 1 --drive "
            f"{self.spec.drive}  # {self.spec.site}, seed {self.spec.seed}: "
            + yaml.safe_dump({"faults": faults}, default_flow_style=True, width=10_000).strip()
        )


@dataclass(frozen=True)
class PairOutcome:
    """What came of a case."""

    case: FaultPair
    findings: int
    success: bool
    uncaused: tuple[str, ...]
    """what was found without a cause"""
    given_up: tuple[str, ...]
    """what the mission came to without a cause"""


def pairs(drive: str) -> tuple[tuple[str, str], ...]:
    """All pairs of kinds of faults that the drive can find, so that neighbours differ."""
    found = [k for k, fault in KINDS.items() if drive != RouteDrive.name or not fault.needs_world]
    ordered = list(product(found, found))
    return tuple(ordered[_STRIDE * n % len(ordered)] for n in range(len(ordered)))


def draw(number: int, drive: str, missions: Sequence[tuple[str, int]] = MISSIONS) -> FaultPair:
    """The case of that number, with one of the missions."""
    rng = generator(number, "fault pair")
    every = pairs(drive)
    while True:
        site, seed = missions[int(rng.integers(len(missions)))]
        mission, record = undisturbed(site, seed)
        data = [_fault(kind, record, rng) for kind in every[number % len(every)]]
        _set_times(data, record, rng)
        faults = FaultFile.model_validate({"faults": data}).faults
        answers = rng.random() < 0.6
        spec = RunSpec(
            mission=mission.model_copy(update={"reactions": REACTIONS if answers else ()}),
            site=site,
            drive=drive,
            seed=number,
            faults=faults,
            events=logged_events(*((t, Resume()) for t in _OPERATOR)),
        )
        if not find_site_errors(faults, open_site(site).site, number):
            return FaultPair(number, spec, float(rng.random()) if rng.random() < 0.25 else None)


@cache
def undisturbed(site: str, seed: int) -> tuple[Mission, RunRecord]:
    """A random mission on a site, and how it is without a fault."""
    opened = open_site(site).prepare()
    mission = random_mission(opened.navigator, seed)
    dock = opened.site.docks[mission.end_area or min(opened.site.docks)]
    mission = mission.model_copy(update={"dock": dock})
    spec = RunSpec(mission=mission, site=site, drive=RouteDrive.name)
    return mission, simulate(spec, opened)


def _fault(kind: str, record: RunRecord, rng: np.random.Generator) -> dict[str, Any]:
    """A fault of that kind, as a rule where the undisturbed run comes by."""
    fault: dict[str, Any] = {"kind": kind}
    if rng.random() < 0.2:
        return fault  # anything, anywhere
    sample = record.path[int(rng.integers(len(record.path)))]
    reading = record.readings[int(rng.integers(len(record.readings)))]
    x, y = round(sample.x, 2), round(sample.y, 2)

    def around(half: float) -> list[float]:
        return [round(v, 2) for v in (x - half, y - half, x + half, y + half)]

    match kind:
        case "abnormal_value" | "displaced_checkpoint":
            fault["checkpoint"] = reading.checkpoint
        case "brick":
            fault |= {"floor": sample.floor, "place": (x, y)}
        case "missing_plate":
            fault |= {"floor": sample.floor, "rect": around(0.3)}
        case "gas_leak":  # a hot spot is on equipment: in mid-air it is placed on what is behind
            fault["place"] = (round(x + 0.6, 2), round(y + 0.6, 2), round(sample.z + 0.9, 2))
        case "low_battery":
            fault["charge"] = round(float(rng.uniform(0.195, 0.21)), 4)
        case "worn_battery":
            fault["capacity"] = round(float(rng.uniform(0.01, 0.2)), 3)
        case "connection_loss":
            if rng.random() < 0.5:
                fault |= {"floor": sample.floor, "rect": around(1.0)}
        case "drive_dysfunction":
            fault["speed"] = float(rng.choice([0.0, 0.3, 0.5, 0.65]))
    return fault


def _set_times(faults: list[dict[str, Any]], record: RunRecord, rng: np.random.Generator) -> None:
    """Lets them begin one after the other, around the moments of the undisturbed run, and end."""
    ends = [run.end for run in record.tasks]
    middles = [(run.start + run.end) / 2 for run in record.tasks]

    def moment(least: float = 0.0) -> float:
        at = float(rng.choice(ends)) + float(rng.choice(_OFF))
        at = at if rng.random() < 0.7 else float(rng.choice(middles))
        return max(least, round(at, 1))

    begins = sorted((moment(), moment()))
    for fault, at in zip(faults, begins, strict=True):
        if "at" not in KINDS[fault["kind"]].model_fields:
            continue
        fault["at"] = at
        lasts = rng.random()
        if lasts < 0.4:
            fault["until"] = round(at + float(rng.choice(_SHORTLY)), 1)
        elif lasts < 0.8 or fault["kind"] == "emergency_stop":
            until = moment(at)
            fault["until"] = round(until if until > at else at + 30.0, 1)


class _Entries(Observer):
    def __init__(self) -> None:
        self.all: list[Entry] = []

    def on_entry(self, entry: Entry) -> None:
        self.all.append(entry)


def examine(number: int, drive: str, missions: Sequence[tuple[str, int]] = MISSIONS) -> PairOutcome:
    """Runs the case of that number."""
    case = draw(number, drive, missions)
    spec, site = case.spec, open_site(case.spec.site)
    entries = _Entries()
    record = simulate(spec, site, observers=[entries])
    uncaused, given_up = without_cause(record, site.site), given_up_without_cause(record)
    if case.resumed is not None:
        past = entries.all[: 1 + int(case.resumed * (len(entries.all) - 1))]
        with Simulation(Executor(lower(spec.mission)), site, spec, past=past) as simulation:
            again = simulation.run()
        resumed = f"resumed at {past[-1].t:g} s, "
        uncaused += tuple(resumed + said for said in without_cause(again, site.site))
        given_up += tuple(resumed + said for said in given_up_without_cause(again))
    return PairOutcome(case, len(record.findings), record.result.success, uncaused, given_up)


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs what the command line asks for, and prints what had no cause."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first", type=parse_seed, default=0, help="number of the first run")
    parser.add_argument("--drive", choices=DRIVES, default=KinematicDrive.name)
    parser.add_argument("--processes", type=int, default=1)
    given = parser.parse_args(arguments)
    numbers = range(given.first, given.first + given.runs)
    findings = uncaused = successes = given_up = 0
    with ProcessPoolExecutor(given.processes, mp_context=get_context("spawn")) as pool:
        for verdict in pool.map(partial(examine, drive=given.drive), numbers):
            findings += verdict.findings
            successes += verdict.success
            uncaused += len(verdict.uncaused)
            given_up += bool(verdict.given_up)
            for said in verdict.uncaused:
                print(f"no cause: {said}\n  {verdict.case}", flush=True)
            for said in verdict.given_up:
                print(f"given up without a cause: {said}\n  {verdict.case}", flush=True)
            done = verdict.case.number - given.first + 1
            if done % 50 == 0:
                print(f"{done} runs, {findings} findings, {uncaused} without a cause", flush=True)
    print(
        f"{given.runs} runs with the drive {given.drive} and two faults each, {successes} missions "
        f"done: of {findings} findings {uncaused} without a cause; {given_up} missions given up "
        "without one"
    )


if __name__ == "__main__":
    main()
