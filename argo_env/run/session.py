"""Complete runs in one call: from a spec, or resumed from a journal."""

import logging
import math
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.initial_state import make_machine
from argo_env.run.journal import Header, Journal, create_journal
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.robot import RobotAction
from argo_env.run.simulation import LoggedEvents, Simulation, never_interrupted
from argo_env.run.spec import RunSpec
from argo_env.run.validation import CheckedRun, check_run

_log = logging.getLogger(__name__)


def run(spec: RunSpec) -> RunRecord:
    """Run the mission of a spec on its site and return the record.

    Unlike `simulate` it has no options; it can be pickled with a spec and sent to worker processes.
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
    interrupted: Callable[[], bool] = never_interrupted,
) -> RunRecord:
    """Run the mission of a spec to its end and return the record. Equal specs give equal records.

    Args:
        spec: the spec of the run. A run that `check_run` has checked on the site is not checked
            again.
        site: the site that the spec names, if it is already open.
        observers: objects that are called with each entry.
        journal: path of a new journal, from which the run can be resumed after its process has
            died.
        replace: whether the journal may replace an existing file.
        gui: whether the world is shown in a window.
        pace: the most simulated seconds that may pass in one second of real time; None: no limit.
        interrupted: function that is called before each step; True stops the run there. The record
            is that of the run so far, and the run can be resumed from its journal.

    Raises:
        ArgoError: the mission makes no sense on this site, there is no such site, drive or sensor,
            the site is not the spec's, or the journal can't be written.
    """
    checked = check_run(spec, site)
    spec, site = checked.spec, checked.site
    machine = make_machine(spec.mission, spec.beginning)
    _log.info(
        "a run on %s: drive %s, sensor %s, seed %d", site.name, spec.drive, spec.sensor, spec.seed
    )
    with ExitStack() as stack:
        all_observers = [*_make_clock(pace), *observers]
        if journal is not None:
            # First, so that no other observer receives an entry that is not yet on disk.
            created = create_journal(Path(journal), Header.from_run(site, spec), replace)
            all_observers.insert(0, stack.enter_context(created))
        simulation = Simulation(machine, site, checked, observers=all_observers, gui=gui)
        return stack.enter_context(simulation).run(interrupted)


def resume(
    journal: Journal,
    site: OpenedSite | None = None,
    *,
    observers: Sequence[Observer] = (),
    events: LoggedEvents = (),
    gui: bool = False,
    pace: float | None = None,
    interrupted: Callable[[], bool] = never_interrupted,
) -> RunRecord:
    """Resume the run of a journal and return the record of the complete run.

    The robot continues from its last known pose, and the action that was running starts again. If
    the run had ended, its record is made again.

    Args:
        journal: the open journal.
        site: the site that the run's spec names, if it is already open.
        observers: objects that are called with each new entry.
        events: further events at their times (s); those whose time has passed occur at once.
        gui: whether the world is shown in a window.
        pace: as for `simulate`.
        interrupted: as for `simulate`.

    Raises:
        ArgoError: the site, the robot, the mission's file or Argo is not what the run began with,
            or there are `events` for a run that has ended.
    """
    if events:
        journal.require_not_ended()
    spec = journal.header.spec
    site = site or open_site(spec.site, load_robot(spec.robot))
    journal.require_inputs_unchanged(site)
    return resume_unchecked(
        journal,
        site,
        observers=observers,
        events=events,
        gui=gui,
        pace=pace,
        interrupted=interrupted,
    )


def resume_unchecked(
    journal: Journal,
    site: OpenedSite,
    *,
    observers: Sequence[Observer] = (),
    events: LoggedEvents = (),
    gui: bool = False,
    pace: float | None = None,
    interrupted: Callable[[], bool] = never_interrupted,
) -> RunRecord:
    """Resume the run of a journal as `resume` does, but without its checks of the journal."""
    spec = journal.header.spec
    machine = make_machine(spec.mission, spec.beginning)
    all_observers = [journal, *_make_clock(pace), *observers]
    with Simulation(
        machine, site, spec, past=journal.entries, events=events, observers=all_observers, gui=gui
    ) as simulation:
        return simulation.run(interrupted)


class RealTimeClock(Observer):
    """Observer that sleeps so that a run is no faster than `pace`; holds the time of its start.

    `pace` is the number of simulated seconds per second of real time.
    """

    def __init__(self, pace: float, sleep: Callable[[float], None] = time.sleep) -> None:
        self._pace = pace
        self._sleep = sleep
        self._start_time: float | None = None

    def on_step(self, now: float, action: RobotAction | None) -> None:  # noqa: ARG002
        if self._start_time is None:
            # A resumed run does not start at 0 s.
            self._start_time = time.monotonic() - now / self._pace
        self._sleep(max(0.0, self._start_time + now / self._pace - time.monotonic()))


def _make_clock(pace: float | None) -> tuple[Observer, ...]:
    if pace is None:
        return ()
    if not 0 < pace < math.inf:
        raise Invalid(
            Message("pace {pace:g}: give the simulated seconds per second, more than 0", pace=pace)
        )
    return (RealTimeClock(pace),)
