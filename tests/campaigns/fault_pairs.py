"""Campaign: each finding of runs with two faults, of all pairs of kinds, has a cause.

    python -m tests.campaigns.fault_pairs --runs 1000
    python -m tests.campaigns.fault_pairs --runs 1000 --drive route
    python -m tests.campaigns.fault_pairs --first 17 --runs 1

Each run has a number, from which all is drawn: the site, a short mission through one or two
checkpoints, whether the mission has reactions, and two faults. Their kinds go through all ordered
pairs that can be detected with the drive. The faults begin and end around the times at which the
mission without faults goes on to the next task: before, at and after them, and in between. Every
fourth run is interrupted somewhere and resumed. Each finding, end of a finding, failure and
abortion must have a cause among the two faults (tests/campaigns/fault_causes.py); one that has none
is printed with the command that repeats the run.
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
from argo_env.run.drives_and_sensors import drive_names
from argo_env.run.log import Entry
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec, logged_events
from argo_env.seeding import generator
from benchmarks.options import parse_seed
from tests.campaigns.fault_causes import failures_without_cause, findings_without_cause
from tests.campaigns.faults import random_mission

MISSIONS = (
    *(("darmstadt", seed) for seed in (1, 2, 3, 10, 14, 22, 31)),
    ("generated:floors=2,size=12x12,stairs=straight,checkpoints=8,seed=1", 1),
    ("umad", 22),
)
"""sites, each with the seed of a random mission that takes one to two minutes"""
_STRIDE = 31  # coprime to the numbers of pairs
_OFFSETS = (-1.0, -0.1, 0.0, 0.1, 1.0)  # s from the end of a task
_DURATIONS = (0.3, 0.9, 1.9, 5.0, 20.0)  # s, of short faults
_RESUME_TIMES = (90.0, 150.0)  # s, times at which a person resumes the mission

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
    """Run with two faults."""

    number: int
    spec: RunSpec
    resumed: float | None
    """share of its entries after which it is interrupted and resumed; None: it is not"""

    def __str__(self) -> str:
        faults = [f.model_dump(mode="json", exclude_none=True) for f in self.spec.faults]
        return (
            f"python -m tests.campaigns.fault_pairs --first {self.number} --runs 1 --drive "
            f"{self.spec.drive}  # {self.spec.site}, seed {self.spec.seed}: "
            + yaml.safe_dump({"faults": faults}, default_flow_style=True, width=10_000).strip()
        )


@dataclass(frozen=True)
class PairOutcome:
    """Result of a case."""

    case: FaultPair
    findings: int
    success: bool
    uncaused: tuple[str, ...]
    """findings without a cause"""
    failures: tuple[str, ...]
    """failures of tasks or of the mission without a cause"""


def kind_pairs(drive: str) -> tuple[tuple[str, str], ...]:
    """Return all ordered pairs of kinds that the drive can detect, in mixed order."""
    kinds = [k for k, fault in KINDS.items() if drive != RouteDrive.name or not fault.needs_world]
    ordered = list(product(kinds, kinds))
    return tuple(ordered[_STRIDE * n % len(ordered)] for n in range(len(ordered)))


def draw_case(number: int, drive: str, missions: Sequence[tuple[str, int]] = MISSIONS) -> FaultPair:
    """Draw the case of that number, with one of the missions."""
    rng = generator(number, "fault pair")
    all_pairs = kind_pairs(drive)
    while True:
        site, seed = missions[int(rng.integers(len(missions)))]
        mission, record = run_without_faults(site, seed)
        data = [_draw_fault(kind, record, rng) for kind in all_pairs[number % len(all_pairs)]]
        _draw_times(data, record, rng)
        faults = FaultFile.model_validate({"faults": data}).faults
        has_reactions = rng.random() < 0.6
        spec = RunSpec(
            mission=mission.model_copy(update={"reactions": REACTIONS if has_reactions else ()}),
            site=site,
            drive=drive,
            seed=number,
            faults=faults,
            events=logged_events(*((t, Resume()) for t in _RESUME_TIMES)),
        )
        if not find_site_errors(faults, open_site(site).site, number):
            return FaultPair(number, spec, float(rng.random()) if rng.random() < 0.25 else None)


@cache
def run_without_faults(site: str, seed: int) -> tuple[Mission, RunRecord]:
    """Return a random mission on a site, and the record of its run without faults."""
    opened = open_site(site).prepare()
    mission = random_mission(opened.navigator, seed)
    dock = opened.site.docks[mission.end_area or min(opened.site.docks)]
    mission = mission.model_copy(update={"dock": dock})
    spec = RunSpec(mission=mission, site=site, drive=RouteDrive.name)
    return mission, simulate(spec, opened)


def _draw_fault(kind: str, record: RunRecord, rng: np.random.Generator) -> dict[str, Any]:
    """Draw a fault of a kind, usually where the run without faults passes."""
    fault: dict[str, Any] = {"kind": kind}
    if rng.random() < 0.2:
        return fault  # all parameters are drawn by the run itself
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
        case "gas_leak":  # a hot spot in mid-air is moved to the equipment behind it
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


def _draw_times(faults: list[dict[str, Any]], record: RunRecord, rng: np.random.Generator) -> None:
    """Draw start and end times of the faults around the ends of tasks without faults."""
    ends = [run.end for run in record.tasks]
    middles = [(run.start + run.end) / 2 for run in record.tasks]

    def draw_time(minimum: float = 0.0) -> float:
        at = float(rng.choice(ends)) + float(rng.choice(_OFFSETS))
        at = at if rng.random() < 0.7 else float(rng.choice(middles))
        return max(minimum, round(at, 1))

    begins = sorted((draw_time(), draw_time()))
    for fault, at in zip(faults, begins, strict=True):
        if "at" not in KINDS[fault["kind"]].model_fields:
            continue
        fault["at"] = at
        choice = rng.random()
        if choice < 0.4:
            fault["until"] = round(at + float(rng.choice(_DURATIONS)), 1)
        elif choice < 0.8 or fault["kind"] == "emergency_stop":
            until = draw_time(at)
            fault["until"] = round(until if until > at else at + 30.0, 1)


class _Entries(Observer):
    def __init__(self) -> None:
        self.all: list[Entry] = []

    def on_entry(self, entry: Entry) -> None:
        self.all.append(entry)


def run_case(
    number: int, drive: str, missions: Sequence[tuple[str, int]] = MISSIONS
) -> PairOutcome:
    """Run the case of that number, and return what has no cause."""
    case = draw_case(number, drive, missions)
    spec, site = case.spec, open_site(case.spec.site)
    entries = _Entries()
    record = simulate(spec, site, observers=[entries])
    uncaused, failures = findings_without_cause(record, site.site), failures_without_cause(record)
    if case.resumed is not None:
        past = entries.all[: 1 + int(case.resumed * (len(entries.all) - 1))]
        with Simulation(Executor(lower(spec.mission)), site, spec, past=past) as simulation:
            again = simulation.run()
        prefix = f"resumed at {past[-1].t:g} s, "
        uncaused += tuple(prefix + text for text in findings_without_cause(again, site.site))
        failures += tuple(prefix + text for text in failures_without_cause(again))
    return PairOutcome(case, len(record.findings), record.result.success, uncaused, failures)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the cases that the command line asks for, and print what has no cause."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000, help="number of runs")
    parser.add_argument("--first", type=parse_seed, default=0, help="number of the first run")
    parser.add_argument("--drive", choices=drive_names(), default=KinematicDrive.name)
    parser.add_argument("--processes", type=int, default=1, help="number of processes")
    options = parser.parse_args(arguments)
    numbers = range(options.first, options.first + options.runs)
    findings = uncaused = successes = failures = 0
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for outcome in pool.map(partial(run_case, drive=options.drive), numbers):
            findings += outcome.findings
            successes += outcome.success
            uncaused += len(outcome.uncaused)
            failures += bool(outcome.failures)
            for text in outcome.uncaused:
                print(f"no cause: {text}\n  {outcome.case}", flush=True)
            for text in outcome.failures:
                print(f"failed without a cause: {text}\n  {outcome.case}", flush=True)
            done = outcome.case.number - options.first + 1
            if done % 50 == 0:
                print(f"{done} runs, {findings} findings, {uncaused} without a cause", flush=True)
    print(
        f"{options.runs} runs with the drive {options.drive} and two faults each, {successes} "
        f"successful missions: of {findings} findings {uncaused} without a cause; {failures} "
        "missions failed without one"
    )


if __name__ == "__main__":
    main()
