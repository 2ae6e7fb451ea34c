"""`argo run`: a mission is driven through its site."""

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from argo_compiler.base.errors import Invalid
from argo_compiler.files.loading import read_bytes
from argo_env.faults.loading import MAX_BYTES, decode_faults
from argo_env.files.folders import make_folder
from argo_env.planning.opening import open_site
from argo_env.run.drives_and_sensors import DRIVES, SENSORS
from argo_env.run.journal import require_free
from argo_env.run.record import RunRecord
from argo_env.run.run_setup import check_spec
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged_events
from argo_env.run.validation import check_run
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.conclusion import Conclusion
from argo_planner.terminal.events import KINDS, READING_FORM, parse_events, parse_values
from argo_planner.terminal.files import check_outputs, read_upload
from argo_planner.terminal.importing import import_and_warn
from argo_planner.terminal.options import (
    EndArea,
    Force,
    Optimise,
    Render,
    Report,
    SiteOption,
    Source,
    StartArea,
    given_options,
    option_name,
)
from argo_planner.terminal.run_display import run_with_display
from argo_planner.terminal.signals import defer_first_signal
from argo_planner.terminal.stored_run import JOURNAL, StoredRun, require_no_unfinished_run
from argo_planner.use_cases.reporting import REPORT_FILES
from argo_planner.use_cases.running import (
    NO_MISSION,
    is_spec,
    spec_of,
    with_mission,
)

DEFAULT_PACE = 5.0


@dataclass(frozen=True)
class _Outputs:
    """Where a run is shown and kept."""

    source: Path
    report: Path | None
    render: Path | None
    recording: Path | None
    journal: Path | None
    gui: bool
    pace: float | None
    """simulated seconds a second"""
    force: bool
    """whether what is there already is replaced"""

    @property
    def keeping(self) -> Path | None:
        """The journal: the one that is named, or one in the report's folder."""
        return self.journal or (self.report and self.report / JOURNAL)

    def check(self, *inputs: Path | str | None) -> None:
        """Raises ArgoError where something can't be written, or is one of the inputs."""
        if not self.force:
            require_no_unfinished_run(self.report, self.journal)
        check_outputs(
            [self.source, *inputs],
            [self.render, self.recording, self.journal],
            [(self.report, REPORT_FILES if self.journal else (*REPORT_FILES, JOURNAL))],
            self.force,
        )
        if self.pace is not None and not self.gui:
            raise Invalid("--pace is how fast the window shows the run: give --gui as well")
        # What films and recordings are made with takes long to import.
        if self.render:
            from argo_env.pictures import check_film

            check_film(self.render)
        if self.recording:
            from argo_env.recording.files import check_recording

            check_recording(self.recording)
        if self.keeping and os.path.exists(self.keeping):
            require_free(self.keeping, self.force)


_DECIDED = (
    "site", "seed", "drive", "sensor", "optimise", "start_area", "end_area", "value", "event",
    "faults",
)  # fmt: skip
"""options that the spec of a run has decided"""


def run(
    context: typer.Context,
    source: Source,
    site: SiteOption = "umad",
    seed: Annotated[int, typer.Option(help="draws what the checkpoints show", min=0)] = 0,
    report: Report = None,
    drive: Annotated[
        str,
        typer.Option(
            help=f"what moves the robot: {', '.join(DRIVES)}", autocompletion=offer_names(DRIVES)
        ),
    ] = "kinematic",
    sensor: Annotated[
        str,
        typer.Option(
            help=f"what reads the checkpoints: {', '.join(SENSORS)}",
            autocompletion=offer_names(SENSORS),
        ),
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
            help=f"what occurs at a time (s), such as 60=gas_leak; {KINDS}, or {READING_FORM}",
        ),
    ] = None,
    faults: Annotated[
        Path | None,
        typer.Option("--faults", metavar="FILE.yaml", help="what goes wrong; see docs/faults.md"),
    ] = None,
    journal: Annotated[
        Path | None,
        typer.Option(
            "--journal",
            metavar="FILE",
            help=f"keep the run on disk, for `argo resume FILE`; with --report, DIR/{JOURNAL} if "
            "not given",
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
    render: Render = None,
    recording: Annotated[
        Path | None,
        typer.Option(
            "--record", metavar="FILE.mcap", help="record the run, for Foxglove and `argo replay`"
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Run a mission in simulation and show the results; a report or a film on request."""
    outputs = _Outputs(source, report, render, recording, journal, gui, pace, force)
    outputs.check(site, faults)
    said = None
    if faults:
        said = decode_faults(read_bytes(faults, "file of faults", MAX_BYTES), str(faults))
    spec = RunSpec(
        mission=NO_MISSION,
        source=os.path.realpath(source),
        drive=drive,
        sensor=sensor,
        seed=seed,
        values=parse_values(value or []),
        events=logged_events(*parse_events(event or [])),
        faults=said.faults if said else (),
    )
    started = time.monotonic()
    upload = read_upload(source)
    if is_spec(upload):
        _refuse_decided(context, source)
        checked = check_run(spec_of(upload))
        opened = checked.site
    else:
        opened = open_site(site)
        spec = spec.model_copy(update={"site": opened.reference})
        check_spec(spec, opened.site, said)  # before it is long
        imported = import_and_warn(upload, opened, start_area, end_area)
        reordering = None
        if optimise:
            from argo_planner.terminal.reordering import optimise_and_show  # brings the solvers

            imported, reordering = optimise_and_show(imported, opened)
        spec = with_mission(spec, imported, reordering)
        checked = check_run(spec, opened, settings=False)
    if report:
        make_folder(report)  # now: what is refused before leaves none behind
    opened.prepare()
    loaded = time.monotonic()
    with defer_first_signal() as interruption:
        conclusion = Conclusion(
            report, render, StoredRun(outputs.keeping, recording, force), interruption
        )
        with conclusion.hint_on_interruption():
            record, recorded = run_with_display(
                checked.spec.mission.max_duration,
                recording,
                source,
                lambda observers: simulate(
                    checked,
                    observers=observers,
                    journal=outputs.keeping,
                    replace=force,
                    gui=gui,
                    pace=(pace or DEFAULT_PACE) if gui else None,
                    interrupted=interruption,
                ),
            )
        took = _took(record, loaded - started, time.monotonic() - loaded)
        if recorded:
            took += f"\n{escape(recorded)}"
        conclusion.conclude(record, opened.site, opened.robot, took)


def _took(record: RunRecord, loading: float, running: float) -> str:
    """How long loading and running took (s), in words."""
    return (
        f"Loading took {loading:.1f} s, the run {running:.1f} s: "
        f"{record.result.duration / max(1e-9, running):.0f} times real time."
    )


def _refuse_decided(context: typer.Context, source: Path) -> None:
    """Raises Invalid for options that change what a spec has decided."""
    for name in given_options(context):
        if name in _DECIDED:
            raise Invalid(
                f"{source}: is the spec of a run, in which {option_name(name)} is decided already"
            )
