"""What a run is kept in, and the command that goes on from there."""

import os
import shlex
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, Invalid
from argo_env.report.files import RECORD
from argo_env.run.journal import Journal, open_journal
from argo_env.run.record import RunRecord
from argo_env.run.simulation import SAMPLE_PERIOD

JOURNAL = "run.journal"
"""the file in a report's folder that keeps the run, unless another one is named"""


@dataclass(frozen=True)
class Kept:
    """Where a run can be had again from."""

    journal: Path | None = None
    recording: Path | None = None
    force: bool = False
    """whether the run replaces what is there already, as then does what goes on with it"""

    def command(self, report: Path | None = None, render: Path | None = None) -> str | None:
        """What goes on with the run, or makes its results anew; None: nothing can."""
        if self.journal is not None and os.path.exists(self.journal):
            words = ["argo", "resume", str(self.journal)]
        elif self.recording is not None and os.path.exists(self.recording):
            words = ["argo", "replay", str(self.recording)]
        else:
            return None
        for option, place in (("--report", report), ("--render", render)):
            if place is not None:
                words += [option, str(place)]
        if self.force and (report or render):
            words.append("--force")
        return shlex.join(words)

    def way_on(self, report: Path | None, render: Path | None) -> str:
        """How a run goes on that is not at its end, in words."""
        command = self.command(report, render)
        if command is not None and self.journal is not None:
            return f"go on with: {command}"
        lost = "nothing is kept to go on from, as --report or --journal would have it"
        return f"what was done is shown by: {command}; {lost}" if command else lost


def require_no_unfinished(report: Path | None, journal: Path | None = None) -> None:
    """Raises Conflict if the journal, or one in the report's folder, is of a run that has not
    ended, so that nobody begins anew what can go on."""
    for place in (journal, report and report / JOURNAL):
        if place and os.path.isfile(place) and _is_unfinished(place):
            raise Conflict(
                f"{place}: a run that has not ended is kept there; go on with it: "
                f"{Kept(place).command(report)}, or choose another place, or begin anew (--force)"
            )


def _is_unfinished(place: Path) -> bool:
    try:
        with open_journal(place) as book:
            return not book.ended
    except Invalid:  # no journal, or a damaged one
        return False


def is_reported(book: Journal, folder: Path) -> bool:
    """Whether the report in a folder is of the journal's run, and tells nothing that another one of
    it would not tell."""
    try:
        record = RunRecord.model_validate_json((folder / RECORD).read_bytes())
    except (OSError, ValidationError):
        return False
    spec = book.header.spec
    made_from = (spec.mission, spec.drive, spec.sensor, spec.seed)
    if (record.mission, record.drive, record.sensor, record.seed) != made_from:
        return False
    tasks = tuple(entry.task for entry in book.entries if entry.task)
    readings = tuple(entry.reading for entry in book.entries if entry.reading)
    reached = book.entries[-1].t + SAMPLE_PERIOD if book.entries else 0.0
    return (
        record.tasks == tasks[: len(record.tasks)]
        and record.readings == readings[: len(record.readings)]
        and record.result.duration <= reached
        and (book.ended or not record.result.ended)
    )
