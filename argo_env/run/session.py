"""Whole runs in one call: of a spec, and from a journal on."""

import logging
import math
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

from argo_compiler.base.errors import Invalid
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.initial_state import make_machine
from argo_env.run.journal import Header, Journal, create_journal
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.robot import RobotAction
from argo_env.run.simulation import LoggedEvents, Simulation, never
from argo_env.run.spec import RunSpec
from argo_env.run.validation import CheckedRun, check_run

_log = logging.getLogger(__name__)


def run(spec: RunSpec) -> RunRecord:
    """Runs the mission of a spec on its site and returns the record: for worker processes, which
    can be sent this function and a spec.

    Raises ArgoError as `simulate` does.
    """
    return simulate(spec)


def simulate(
    spec: RunSpec | CheckedRun,
    site: OpenedSite | None = None,
    *,
    observers: Sequence[Observer] = (),
    journal: Path | None = None,
    replace: bool = False,
    gui: bool = False,
    pace: float | None = None,
    interrupted: Callable[[], bool] = never,
) -> RunRecord:
    """Run the mission of a spec to its end and return the record. Equal specs give equal records.

    The `site` is the one that the spec names, if it is open already. A run that `check_run` has
    checked on it is not checked again. With a `journal` the run can be resumed after its
    process has died: a new file, or with `replace` one that is there already. With `pace` a second
    of wall time shows at most that many seconds of simulated time. The function `interrupted` is
    asked after each step whether the run is to stop there: the record is as it stands then, and a
    journal can go on.

    Raises:
        ArgoError: the mission makes no sense on this site, there is no such site, drive or sensor,
            the site is not the spec's, or the journal can't be written.
    """
    known = check_run(spec, site)
    spec, site = known.spec, known.site
    machine = make_machine(spec.mission, spec.beginning)
    _log.info(
        "a run on %s: drive %s, sensor %s, seed %d", site.name, spec.drive, spec.sensor, spec.seed
    )
    with ExitStack() as stack:
        told = [*_paced(pace), *observers]
        if journal is not None:
            # First, so that nobody is told what is not on disk.
            book = create_journal(Path(journal), Header.from_run(site, spec), replace)
            told.insert(0, stack.enter_context(book))
        simulation = Simulation(machine, site, known, observers=told, gui=gui)
        return stack.enter_context(simulation).run(interrupted)


def resume(
    journal: Journal,
    site: OpenedSite | None = None,
    *,
    observers: Sequence[Observer] = (),
    events: LoggedEvents = (),
    gui: bool = False,
    pace: float | None = None,
    interrupted: Callable[[], bool] = never,
) -> RunRecord:
    """Go on with the run of a journal and return the record of the whole of it.

    The robot goes on from where it was last known to be, and the action that ran begins anew. If
    the run had ended, its record is made again. Further `events` occur at their times (s), at once
    if these are over. It may be `interrupted` as in `simulate`.

    Raises:
        ArgoError: the site, the robot, the mission's file or Argo is not what the run began with,
            or there are `events` for a run that has ended.
    """
    if events:
        journal.require_not_ended()
    spec = journal.header.spec
    site = site or open_site(spec.site, load_robot(spec.robot))
    journal.require_unchanged(site)
    return continue_run(
        journal,
        site,
        observers=observers,
        events=events,
        gui=gui,
        pace=pace,
        interrupted=interrupted,
    )


def continue_run(
    journal: Journal,
    site: OpenedSite,
    *,
    observers: Sequence[Observer] = (),
    events: LoggedEvents = (),
    gui: bool = False,
    pace: float | None = None,
    interrupted: Callable[[], bool] = never,
) -> RunRecord:
    """Resume the run of a journal that is known to go on with what it began with."""
    spec = journal.header.spec
    machine = make_machine(spec.mission, spec.beginning)
    told = [journal, *_paced(pace), *observers]
    with Simulation(
        machine, site, spec, past=journal.entries, events=events, observers=told, gui=gui
    ) as simulation:
        return simulation.run(interrupted)


class RealTimeClock(Observer):
    """Lets a run go on no faster than so many simulated seconds a second. Holds when it began."""

    def __init__(self, pace: float, sleep: Callable[[float], None] = time.sleep) -> None:
        self._pace = pace
        self._sleep = sleep
        self._begun: float | None = None

    def on_step(self, now: float, action: RobotAction | None) -> None:  # noqa: ARG002
        if self._begun is None:
            # A run that is resumed does not begin at 0.
            self._begun = time.monotonic() - now / self._pace
        self._sleep(max(0.0, self._begun + now / self._pace - time.monotonic()))


def _paced(pace: float | None) -> tuple[Observer, ...]:
    if pace is None:
        return ()
    if not 0 < pace < math.inf:
        raise Invalid(f"pace {pace:g}: give the simulated seconds a second, more than 0")
    return (RealTimeClock(pace),)
