"""Campaign: missions whose charging is cut short, by limits and by people.

    python -m tests.campaigns.charging --missions 1000

Batteries, levels, limits and the times at which a person resumes are drawn from a seed. In each run
the reports of a low battery are compared with the recorded charge: once the charge has been above
the level by 1 %, and after each charging, the next report must come before more is used than the
rules allow (R11). Prints each run in which a report is missing or a hold ends without its charge
(R12); the exit status is then 1.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Resume
from argo_compiler.il import Afterwards, EventKind, Group, Mission, Reaction, Response
from argo_env.drives.battery import ESTIMATE_ERROR
from argo_env.run.record import RunRecord
from argo_env.run.spec import RunConditions, logged_events
from argo_env.seeding import generator
from argo_env.sensing.battery_watch import MARGIN
from tests.yard import measure, mission, simulated, yard

DOCK = Pose(x=1.05, y=1.05, z=0.02)
TOLERANCE = 2 * ESTIMATE_ERROR + 0.005
"""share of the battery: errors of the estimates at both ends, and what is used between reports"""


@dataclass(frozen=True)
class Case:
    """Mission, battery and resumptions of one run."""

    plan: Mission
    conditions: RunConditions
    resumptions: tuple[float, ...]
    """s, times at which a person resumes the mission"""


def draw_case(seed: int) -> Case:
    """Return the case of a seed."""
    rng = generator(seed, "charging")
    level = round(float(rng.uniform(0.1, 0.6)), 2)
    goal = None if rng.random() < 0.3 else round(float(rng.uniform(level + 0.02, 1.0)), 2)
    least = round(float(rng.uniform(5.0, 60.0)), 1) if rng.random() < 0.3 else None
    limit = None if rng.random() < 0.3 else round(float(rng.uniform(5.0, 120.0)), 1)
    if least is not None and limit is not None and limit <= least:
        limit = least + 1.0
    reaction = Reaction(
        event=EventKind.LOW_BATTERY,
        response=Response.RETURN,
        until=EventKind.BATTERY_CHARGED,
        afterwards=Afterwards.RESUME,
        battery_below=level,
        charge_to=goal,
        charge_for=least,
        hold_limit=limit,
        on_limit=Afterwards.WAIT if limit is None else Afterwards.RESUME,
    )
    rounds = Group(
        name="G", start="MEASURE 1", end="MEASURE 2", max_repeat_count=int(rng.integers(5, 25))
    )
    plan = mission(measure(1), measure(2), groups=(rounds,), reactions=(reaction,), dock=DOCK)
    charge = round(float(min(1.0, rng.uniform(level, level + 0.03))), 3)
    conditions = RunConditions(charge=charge, capacity=round(float(rng.uniform(0.05, 0.4)), 2))
    count = 0 if rng.random() < 0.4 else int(rng.integers(1, 20))
    return Case(plan, conditions, tuple(sorted(map(float, rng.uniform(5.0, 1500.0, count)))))


def missing_reports(record: RunRecord, level: float) -> list[str]:
    """Return the times at which a low battery had to have been reported, and was not.

    This follows the recorded charge only, with the errors of the estimates in favour of the robot.
    """
    reports = [found.t for found in record.anomalies if found.kind is EventKind.LOW_BATTERY]
    missing: list[str] = []
    armed, before = level, None
    for sample in record.path:
        charge = sample.charge
        assert charge is not None
        reported = bool(reports) and reports[0] <= sample.t
        while reports and reports[0] <= sample.t:
            reports.pop(0)
        if reported:
            armed = 0.0
        if charge >= level + MARGIN + ESTIMATE_ERROR:
            armed = level
        elif before is not None and charge > before:
            armed = max(armed, charge - MARGIN)
        if armed and charge < armed - TOLERANCE:
            missing.append(f"no report at {sample.t:.1f} s with {charge:.1%}, due at {armed:.1%}")
            armed = 0.0
        before = charge
    return missing


def holds_without_charge(record: RunRecord, reaction: Reaction) -> list[str]:
    """Return the reports of a charged battery that come without the charge."""
    goal = reaction.charge_to
    if goal is None:
        goal = 0.99 if reaction.charge_for is None else 0.0
    wrong = []
    for found in record.anomalies:
        if found.kind is not EventKind.BATTERY_CHARGED:
            continue
        near = min(record.path, key=lambda sample: abs(sample.t - found.t))
        assert near.charge is not None
        if near.charge < min(goal, 0.99) - TOLERANCE:
            wrong.append(f"charged at {found.t:.1f} s with {near.charge:.1%}, not {goal:.0%}")
    return wrong


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign, and return its exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--missions", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first mission")
    parser.add_argument("--drive", default="route")
    options = parser.parse_args(arguments)
    navigator = yard()
    reports = cut_short = faults = 0
    for seed in range(options.first, options.first + options.missions):
        case = draw_case(seed)
        (reaction,) = case.plan.reactions
        assert reaction.battery_below is not None
        record = simulated(
            case.plan,
            navigator,
            drive=options.drive,
            seed=seed,
            conditions=case.conditions,
            events=logged_events(*((t, Resume()) for t in case.resumptions)),
        )
        kinds = [found.kind for found in record.anomalies]
        reports += kinds.count(EventKind.LOW_BATTERY)
        holds = [i for i in record.interruptions if i.event is EventKind.LOW_BATTERY]
        cut_short += len(holds) - kinds.count(EventKind.BATTERY_CHARGED)
        wrong = missing_reports(record, reaction.battery_below)
        for message in (*wrong, *holds_without_charge(record, reaction)):
            faults += 1
            print(f"seed {seed}: {message}")
    print(
        f"{options.missions} missions, {reports} reports of a low battery, {cut_short} chargings "
        f"cut short, {faults} faults"
    )
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
