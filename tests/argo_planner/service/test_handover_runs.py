"""Law of handover, through the service.

The tasks done before, by hand and after a handover are those that the mission would have done.
"""

import random
import time
from collections import Counter

import pytest

from argo_compiler.hfsm import Executor, lower
from argo_compiler.il import Action, Group, Mission, Task
from argo_env.planning.opening import OpenedSite
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from tests.argo_planner.service.served import Served
from tests.argo_planner.service.test_http import new_resource
from tests.argo_planner.service.test_runs import ask, state, wait_for, wait_for_answer
from tests.conftest import seeds
from tests.yard import from_place


def random_mission(rng: random.Random, site: OpenedSite) -> Mission:
    """Return a mission with some checkpoints of one floor, some of which may form a group."""
    floor = rng.choice(sorted({c.floor for c in site.site.checkpoints}))
    numbers = [c.id for c in site.site.checkpoints if c.floor == floor]
    chosen = rng.sample(numbers, min(len(numbers), rng.randint(2, 4)))
    dock = site.site.docks[min(site.site.docks)]
    tasks = [Task(name=f"M{id}", action=Action.MEASURE, object_id=str(id)) for id in chosen]
    first = rng.randrange(len(chosen))
    last = rng.randrange(first, len(chosen))
    group = Group(
        name="round", start=f"M{chosen[first]}", end=f"M{chosen[last]}", max_repeat_count=2
    )
    groups = (group,) if rng.random() < 0.5 else ()
    return from_place(dock, *tasks, groups=groups)


def count_visits(mission: Mission, site: OpenedSite) -> Counter[str]:
    """Return the number of visits of each task if nobody interrupts the mission."""
    spec = RunSpec(mission=mission, site=site.reference, drive="route")
    with Simulation(Executor(lower(mission)), site, spec) as simulation:
        simulation.run()
        return Counter({t.task: t.done for t in simulation.machine.progress().tallies})


def run_randomly(service: Served, site: OpenedSite, seed: int) -> str:
    """Run a random mission in which a person takes over; return the person's actions."""
    rng = random.Random(seed)
    mission = random_mission(rng, site)
    expected = count_visits(mission, site)
    id = service.create(f"Run {seed}", mission.model_dump(mode="json"))
    run = new_resource(service.run(id, drive="route", speed=60.0), 201, "/api/runs")["id"]
    until = rng.uniform(0.0, 60.0)
    while (now := state(service, run))["t"] < until and now["status"] != "ended":
        time.sleep(0.02)
    actions = []
    if ask(service, run, "take_over")["progress"] == "confirmed":
        ask(service, run, "speed", speed=None)
        counts = Counter({t["task"]: t["done"] for t in state(service, run)["tasks"]})
        left = [name for name in expected if counts[name] < expected[name]]
        for name in rng.sample(left, rng.randint(0, len(left))):
            kind = rng.choice(["do_task", "skip"])
            assert ask(service, run, kind, task=name)["progress"] == "confirmed"
            actions.append(kind)
        if rng.random() < 0.5:
            task = rng.choice(mission.tasks[1:]).name
            edit = {"kind": "change_task", "name": task, "velocity": 0.25}
            assert service.command(id, 1, edit).status_code == 200
            answer = wait_for_answer(service, service.post(f"/api/runs/{run}/plan", 2, id="edited"))
            if answer["progress"] == "refused":
                assert "nothing" in answer["reason"]  # nothing is left to continue with
                assert ask(service, run, "give_back")["progress"] == "confirmed"
            else:
                assert answer["progress"] == "confirmed", answer
                assert state(service, run)["revision"] == 2
            actions.append("edited")
        else:
            assert ask(service, run, "give_back")["progress"] == "confirmed"
            actions.append("given back")
    ended = wait_for(service, run, status="ended")
    counts = Counter({t["task"]: t["done"] + t["by_hand"] for t in ended["tasks"]})
    assert counts == expected, (seed, actions)
    count = service.client.get(f"/api/runs/{run}/entries", params={"since": 10**6}).json()["count"]
    assert count == ended["entries"]
    return " ".join(actions)


@pytest.mark.long
def test_tasks_by_hand_and_an_edited_mission(service: Served, site: OpenedSite) -> None:
    assert {seed: run_randomly(service, site, seed).split()[-1:] for seed in (0, 3)}


@pytest.mark.long
def test_many_random_runs(service: Served, site: OpenedSite) -> None:
    tested = seeds(8)
    actions = Counter(word for seed in tested for word in run_randomly(service, site, seed).split())
    assert len(tested) < 8 or {"do_task", "skip", "edited", "given", "back"} <= actions.keys()
