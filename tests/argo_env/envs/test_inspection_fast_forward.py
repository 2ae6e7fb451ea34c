"""An inspection that goes from event to event reports the same as one that goes step by step."""

import random

import pytest

from argo_env.envs.inspection_run import Inspection, initial_mission
from argo_env.faults.loading import decode_faults
from argo_env.planning.opening import open_site
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunConditions, RunSpec
from argo_env.run.validation import check_run
from tests.conftest import seeds

SITE = open_site("umad")
FAULTS = (
    "{kind: low_battery, charge: 0.12}",
    "{kind: low_battery, charge: 0.006}",
    "{kind: worn_battery, capacity: 0.2}",
    "{kind: emergency_stop, at: 31.27, until: 52.1}",
    "{kind: connection_loss, at: 60, until: 90}",
    "{kind: drive_dysfunction, at: 12, until: 80}",
)


def results_of(seed: int) -> list[object]:
    """Return all that a random inspection reports."""
    chosen = random.Random(seed)
    docks = SITE.site.docks
    faults = ", ".join(chosen.sample(FAULTS, chosen.choice([0, 1, 1, 2])))
    spec = RunSpec(
        mission=initial_mission(SITE, docks[chosen.choice([1, 2])]),
        drive="route",
        seed=seed,
        faults=decode_faults(f"faults: [{faults}]".encode(), "test").faults,
        conditions=RunConditions(charge=chosen.choice([None, 0.97, 0.995, 0.3])),
    )
    results: list[object] = []
    with Inspection(check_run(spec, SITE), chosen.choice([150.0, 400.0, 1500.0])) as run:
        while not (run.is_time_up or run.is_battery_empty or len(results) > 20):
            match chosen.randrange(3):
                case 0:
                    result = run.measure_checkpoint(chosen.choice(SITE.site.checkpoints).id)
                case 1:
                    result = run.drive_to(docks[chosen.choice([1, 2])])
                    if not (run.is_time_up or run.is_battery_empty):
                        result = run.stay(chosen.choice([0.0, 10.0]), longer_until_full=True)
                case _:
                    result = run.stay(chosen.choice([0.05, 0.3, 33.3, 200.0]))
            results += [result, run.now, run.charge, run.pose]
        return [*results, run.trail, run.kinds_noticed_so_far, run.record().model_dump_json()]


@pytest.mark.parametrize("seed", seeds(20))
def test_fast_forward_equals_single_steps(seed, monkeypatch):
    fast_results = results_of(seed)
    monkeypatch.setattr(Simulation, "fast_forward", lambda self, until: self.step() or ())  # noqa: ARG005
    for fast, slow in zip(fast_results, results_of(seed), strict=True):
        assert fast == slow
