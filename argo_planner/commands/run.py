"""`argo run`: run a mission in simulation."""

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
from argo_env.run.drives_and_sensors import SENSORS, drive_names
from argo_env.run.journal import check_journal_path
from argo_env.run.record import RunRecord
from argo_env.run.run_setup import check_spec
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged_events
from argo_env.run.validation import check_run
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.conclusion import Conclusion
from argo_planner.terminal.events import KINDS, READING_FORM, parse_checkpoint_values, parse_events
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
from argo_planner.terminal.run_display import run_and_describe_recording
from argo_planner.terminal.run_storage import JOURNAL, RunStorage, require_no_unfinished_run
from argo_planner.terminal.signals import defer_first_signal
from argo_planner.use_cases.reporting import REPORT_FILES
from argo_planner.use_cases.running import (
    NO_MISSION,
    is_run_spec,
    load_spec,
    with_mission,
)

DEFAULT_PACE = 5.0


@dataclass(frozen=True)
class _Outputs:
    """Outputs of a run."""

    source: Path
    report: Path | None
    render: Path | None
    recording: Path | None
    journal: Path | None
    gui: bool
    pace: float | None
    """simulated seconds per second; None: not given"""
    force: bool
    """whether existing files are replaced"""

    @property
    def journal_path(self) -> Path | None:
        """Path of the journal: the given one, or one in the report's folder; None: neither."""
        return self.journal or (self.report and self.report / JOURNAL)

    def require_valid(self, *inputs: Path | str | None) -> None:
        """Raise ArgoError if an output can't be written, exists or is one of the inputs.

        With `--force`, it may exist. None among the inputs does not count.
        """
        if not self.force:
            require_no_unfinished_run(self.report, self.journal)
        check_outputs(
            [self.source, *inputs],
            [self.render, self.recording, self.journal],
            [(self.report, REPORT_FILES if self.journal else (*REPORT_FILES, JOURNAL))],
            self.force,
        )
        if self.pace is not None and not self.gui:
            raise Invalid(
                "--pace sets the speed of the window: give --gui as well, or leave --pace out"
            )
        # The modules for films and recordings take long to import.
        if self.render:
            from argo_env.pictures import check_film

            check_film(self.render)
        if self.recording:
            from argo_env.recording.files import check_recording_path

            check_recording_path(self.recording)
        if self.journal_path and os.path.exists(self.journal_path):
            check_journal_path(self.journal_path, self.force)


_SPEC_OPTIONS = (
    "site", "seed", "drive", "sensor", "optimise", "start_area", "end_area", "value", "event",
    "faults",
)  # fmt: skip
"""options whose values the spec of a run sets, so that they can't be given with one"""


def run_command(
    context: typer.Context,
    source: Source,
    site: SiteOption = "umad",
    seed: Annotated[
        int, typer.Option(help="seed of the random values of the checkpoints", min=0)
    ] = 0,
    report: Report = None,
    drive: Annotated[
        str,
        typer.Option(
            help=f"model of the robot's motion: {', '.join(drive_names())}",
            autocompletion=offer_names(drive_names),
        ),
    ] = "kinematic",
    sensor: Annotated[
        str,
        typer.Option(
            help=f"how checkpoints are read: {', '.join(SENSORS)}",
            autocompletion=offer_names(SENSORS.names),
        ),
    ] = "ideal",
    optimise: Optimise = False,
    start_area: StartArea = None,
    end_area: EndArea = None,
    value: Annotated[
        list[str] | None,
        typer.Option(
            "--value", metavar="ID=VALUE", help="value that a checkpoint shows, such as 8=4.2"
        ),
    ] = None,
    event: Annotated[
        list[str] | None,
        typer.Option(
            "--event",
            metavar="TIME=KIND",
            help=f"event at a time in s, such as 60=gas_leak; KIND: {KINDS}, or {READING_FORM}",
        ),
    ] = None,
    faults: Annotated[
        Path | None,
        typer.Option(
            "--faults", metavar="FILE.yaml", help="file of faults; see `argo docs faults`"
        ),
    ] = None,
    journal: Annotated[
        Path | None,
        typer.Option(
            "--journal",
            metavar="FILE",
            help="store the run in this file, so that `argo resume` can continue it; "
            f"DIR/{JOURNAL} if not given, with --report",
        ),
    ] = None,
    gui: Annotated[bool, typer.Option("--gui", help="show the run in PyBullet's window")] = False,
    pace: Annotated[
        float | None,
        typer.Option(
            help=f"with --gui: simulated seconds per second at most; {DEFAULT_PACE:g} if not given",
            min=0.1,
        ),
    ] = None,
    render: Render = None,
    recording: Annotated[
        Path | None,
        typer.Option(
            "--record", metavar="FILE.mcap", help="record the run for Foxglove and `argo replay`"
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Run a mission, or the spec of an earlier run, in simulation, and show the results."""
    outputs = _Outputs(source, report, render, recording, journal, gui, pace, force)
    outputs.require_valid(site, faults)
    fault_text = None
    if faults:
        fault_text = decode_faults(read_bytes(faults, "file of faults", MAX_BYTES), str(faults))
    spec = RunSpec(
        mission=NO_MISSION,
        source=os.path.realpath(source),
        drive=drive,
        sensor=sensor,
        seed=seed,
        values=parse_checkpoint_values(value or []),
        events=logged_events(*parse_events(event or [])),
        faults=fault_text.faults if fault_text else (),
    )
    started = time.monotonic()
    upload = read_upload(source)
    if is_run_spec(upload):
        _require_no_spec_options(context, source)
        checked = check_run(load_spec(upload))
        opened = checked.site
    else:
        opened = open_site(site)
        spec = spec.model_copy(update={"site": opened.reference})
        check_spec(spec, opened.site, fault_text)  # before slow work
        imported = import_and_warn(upload, opened, start_area, end_area)
        reordering = None
        if optimise:
            from argo_planner.terminal.reordering import optimise_and_show  # imports the solvers

            imported, reordering = optimise_and_show(imported, opened)
        spec = with_mission(spec, imported, reordering)
        checked = check_run(spec, opened, settings=False)
    if report:
        make_folder(report)  # only now, so that a refused command leaves no folder
    opened.prepare()
    loaded = time.monotonic()
    with defer_first_signal() as interruption:
        conclusion = Conclusion(
            report, render, RunStorage(outputs.journal_path, recording, force), interruption
        )
        with conclusion.exit_with_hint_on_interruption():
            record, recorded = run_and_describe_recording(
                checked.spec.mission.max_duration,
                recording,
                source,
                lambda observers: simulate(
                    checked,
                    observers=observers,
                    journal=outputs.journal_path,
                    replace=force,
                    gui=gui,
                    pace=(pace or DEFAULT_PACE) if gui else None,
                    interrupted=interruption,
                ),
            )
        took = _times_text(record, loaded - started, time.monotonic() - loaded)
        if recorded:
            took += f"\n{escape(recorded)}"
        conclusion.write_report_and_show_results(record, opened.site, opened.robot, took)


def _times_text(record: RunRecord, loading: float, running: float) -> str:
    """Return a sentence about the times in s that loading and running took."""
    return (
        f"Loading took {loading:.1f} s, the run {running:.1f} s: "
        f"{record.result.duration / max(1e-9, running):.0f} times real time."
    )


def _require_no_spec_options(context: typer.Context, source: Path) -> None:
    """Raise Invalid if an option is given that is set by the spec of a run, which `source` is."""
    for name in given_options(context):
        if name in _SPEC_OPTIONS:
            raise Invalid(
                f"{source} is the spec of a run, which sets {option_name(name)} itself: leave the "
                "option out"
            )
