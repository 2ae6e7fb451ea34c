"""The process of a run: opens the site, drives the simulation, keeps its journal."""

import time
from contextlib import ExitStack
from multiprocessing.connection import Connection
from pathlib import Path

from argo_compiler.errors import ArgoError
from argo_compiler.hfsm import Executor, lower
from argo_env.planning.opening import open_site
from argo_env.run.journal import Header, create_journal, open_journal
from argo_env.run.record import RunRecord
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from argo_planner.service.jobs.orphans import end_with_parent
from argo_planner.service.runs.driver import RunDriver, RunTeller
from argo_planner.service.runs.requests import RunOrder
from argo_planner.service.runs.state import RunState, RunStatus, StateTold
from argo_planner.service.world.obstacles import with_obstacles
from argo_planner.use_cases.reporting import report_files

JOURNAL = "run.journal"


def carry_out(pipe: Connection, folder: Path, order: RunOrder, first: RunState) -> None:
    """Carries a run out, or goes on with the journal that is in its folder. Through the pipe come
    requests with who sends them, and go all that is to be told."""
    end_with_parent()
    try:
        record = _carried_out(pipe, folder, order, first)
    except ArgoError as error:
        broken = {"status": RunStatus.INTERRUPTED, "problem": str(error)}
        pipe.send(StateTold(state=first.model_copy(update=broken)))
        return
    if record is not None:
        _report(record, folder, order)


def _carried_out(
    pipe: Connection, folder: Path, order: RunOrder, first: RunState
) -> RunRecord | None:
    site = with_obstacles(open_site(order.site).prepare(), order.obstacles)
    path = folder / JOURNAL
    with ExitStack() as stack:
        if path in [*folder.iterdir()]:
            journal = stack.enter_context(open_journal(path))
            journal.require_unchanged(site)
        else:
            spec = RunSpec(
                mission=order.mission,
                site=order.site,
                drive=order.drive,
                sensor=order.sensor,
                seed=order.seed,
                values=order.values,
                faults=order.faults,
            )
            journal = stack.enter_context(create_journal(path, Header.of(site, spec)))
        teller = RunTeller(first.id, pipe.send, journal.entries)
        simulation = stack.enter_context(
            Simulation(
                Executor(lower(journal.header.spec.mission)),
                site,
                journal.header.spec,
                past=journal.entries,
                observers=[journal, teller],
            )
        )
        driver = RunDriver(simulation, first, teller, pipe.send, time.monotonic)
        driver.tell_state()
        while not driver.over:
            left = driver.turn()
            if pipe.poll(max(0.0, left)):
                driver.ask(*pipe.recv())
        driver.tell_state()
        return simulation.record()


def _report(record: RunRecord, folder: Path, order: RunOrder) -> None:
    site = with_obstacles(open_site(order.site), order.obstacles)
    for name, content in report_files(record, site.site, site.robot).items():
        (folder / name).write_bytes(content)
