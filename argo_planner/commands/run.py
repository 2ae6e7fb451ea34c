"""`argo run`: a mission is driven through its site."""

import math
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.errors import ArgoError
from argo_compiler.hfsm import Cancel, Event, Occurred, Pause, Resume, lower
from argo_compiler.il import EventKind, Mission
from argo_env.faults.reading import read_faults, require_fit
from argo_env.files.folders import make_folder
from argo_env.pictures import check_film
from argo_env.planning import open_site
from argo_env.recording.files import check_recording, recording_to
from argo_env.run.drives_and_sensors import DRIVES, SENSORS
from argo_env.run.journal import require_free
from argo_env.run.observer import Observer
from argo_env.run.rig import check_spec
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged
from argo_planner.loading import keep_input, load_mission
from argo_planner.options import EndArea, Optimise, SiteOption, Source, StartArea
from argo_planner.routing import optimised
from argo_planner.running import RunDisplay, conclude

DEFAULT_PACE = 5.0
_NONE = Mission(tasks=())
"""until the mission is read"""

_BY_A_PERSON: dict[str, Event] = {"pause": Pause(), "resume": Resume(), "cancel": Cancel()}

KINDS = ", ".join(["pause", "resume", "cancel", *EventKind])


def run(
    source: Source,
    site: SiteOption = "umad",
    seed: Annotated[int, typer.Option(help="draws what the checkpoints show", min=0)] = 0,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="DIR", help="folder for the report")
    ] = None,
    drive: Annotated[str, typer.Option(help=f"what moves the robot: {', '.join(DRIVES)}")] = (
        "kinematic"
    ),
    sensor: Annotated[
        str, typer.Option(help=f"what reads the checkpoints: {', '.join(SENSORS)}")
    ] = "ideal",
    optimise: Optimise = False,
    start_area: StartArea = None,
    end_area: EndArea = None,
    value: Annotated[
        list[str] | None,
        typer.Option("--value", metavar="ID=VALUE", help="what a checkpoint shows, such as 8=4.2"),
    ] = None,
    event: Annotated[
        list[str] | None,
        typer.Option(
            "--event",
            metavar="TIME=KIND",
            help=f"what occurs at a time (s), such as 60=gas_leak; {KINDS}",
        ),
    ] = None,
    faults: Annotated[
        Path | None,
        typer.Option("--faults", metavar="FILE.yaml", help="what goes wrong; see docs/faults.md"),
    ] = None,
    journal: Annotated[
        Path | None,
        typer.Option(
            "--journal", metavar="FILE", help="keep the run on disk, for `argo resume FILE`"
        ),
    ] = None,
    gui: Annotated[bool, typer.Option("--gui", help="open PyBullet's window")] = False,
    pace: Annotated[
        float | None,
        typer.Option(
            help=f"with --gui: simulated seconds a second, at most; {DEFAULT_PACE:g} if not given",
            min=0.1,
        ),
    ] = None,
    render: Annotated[
        Path | None, typer.Option("--render", metavar="FILE.mp4|FILE.gif", help="film the run")
    ] = None,
    recording: Annotated[
        Path | None,
        typer.Option(
            "--record", metavar="FILE.mcap", help="record the run, for Foxglove and `argo replay`"
        ),
    ] = None,
) -> None:
    """Run a mission on a site, show what was measured, and write a report."""
    if pace is not None and not gui:
        raise ArgoError("--pace is how fast the window shows the run: give --gui as well")
    if render:
        check_film(render)
    if recording:
        check_recording(recording)
        keep_input(source, recording)
    if report:
        make_folder(report)
    spec = RunSpec(
        mission=_NONE,
        site=site_reference(site),
        source=str(source.resolve()),
        drive=drive,
        sensor=sensor,
        seed=seed,
        values=parse_values(value or []),
        events=logged(*parse_events(event or [])),
        faults=read_faults(faults) if faults else (),
    )
    if journal:
        require_free(journal)
    started = time.monotonic()
    opened = open_site(site)
    navigator = opened.navigator
    if faults:
        require_fit(spec.faults, faults, navigator.site, seed)
    check_spec(spec, navigator.site)  # before it is long
    mission, diagnostics = load_mission(source, navigator, start_area, end_area)
    reordering = None
    if optimise:
        mission, reordering = optimised(source, mission, navigator)
    known = {"mission": mission, "diagnostics": diagnostics, "reordering": reordering}
    spec = spec.model_copy(update=known)
    lower(mission, source_name=str(source))
    navigator.prepare()
    loaded = time.monotonic()
    with ExitStack() as stack:
        observers: list[Observer] = [stack.enter_context(RunDisplay(mission.max_duration))]
        if recording:
            observers.append(stack.enter_context(recording_to(recording, source)))
        record = simulate(
            spec,
            opened,
            observers=observers,
            journal=journal,
            gui=gui,
            pace=(pace or DEFAULT_PACE) if gui else None,
        )
    ended = time.monotonic()
    took = (
        f"Loading took {loaded - started:.1f} s, the run {ended - loaded:.1f} s: "
        f"{record.result.duration / max(1e-9, ended - loaded):.0f} times real time."
    )
    if recording:
        took += f"\nRecording: {recording}"
    conclude(record, navigator, took, report, render)


def site_reference(site: str) -> str:
    """What finds the site again from any folder: its name, or the whole path of its file."""
    return str(Path(site).resolve()) if Path(site).suffix in {".yaml", ".yml"} else site


def parse_events(options: list[str]) -> list[tuple[float, Event]]:
    """What `--event TIME=KIND` says, by time; ArgoError if it is said otherwise."""
    kinds = {str(kind): Occurred(kind) for kind in EventKind if kind is not EventKind.TIME_UP}
    known: dict[str, Event] = {**kinds, **_BY_A_PERSON}
    events = []
    for option in options:
        at, _, name = option.partition("=")
        try:
            time_s = float(at)
        except ValueError:
            time_s = math.nan
        if not 0.0 <= time_s < math.inf:
            raise ArgoError(f"--event {option}: write TIME=KIND in s, such as 60=gas_leak")
        if name == EventKind.TIME_UP:
            raise ArgoError(f"--event {option}: it occurs by itself, at the mission's max_duration")
        if name not in known:
            raise ArgoError(f"--event {option}: no event `{name}`; there are: {', '.join(known)}")
        events.append((time_s, known[name]))
    return sorted(events, key=lambda event: event[0])


def parse_values(options: list[str]) -> dict[int, float]:
    """What `--value ID=VALUE` says; ArgoError if it is said otherwise, or twice of one id."""
    values: dict[int, float] = {}
    for option in options:
        id, _, value = option.partition("=")
        try:
            number, shown = int(id), float(value)
            if not math.isfinite(shown):
                raise ValueError(value)
        except ValueError:
            raise ArgoError(f"--value {option}: write ID=VALUE, such as 8=4.2") from None
        if number in values:
            raise ArgoError(f"--value {option}: checkpoint {number} has been given a value already")
        values[number] = shown
    return values
