"""The journal or recording that stores a run, and the command that continues it."""

import os
import shlex
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, Invalid
from argo_env.files.checked_files import read_checked
from argo_env.report.files import PAGE, RECORD
from argo_env.run.journal import Journal, open_journal
from argo_env.run.record import RunRecord
from argo_env.run.simulation import SAMPLE_PERIOD
from argo_planner.use_cases.reporting import REPORT_FILES

_REMEDY = "restore it from a copy, or delete it: the report is written from the journal"
JOURNAL = "run.journal"
"""name of the journal in a report's folder, unless another journal is named"""
_RECORDED = (".gif", ".mp4", ".mcap")
"""suffixes of films and recordings"""


@dataclass(frozen=True)
class RunStorage:
    """The files that store a run."""

    journal: Path | None = None
    recording: Path | None = None
    force: bool = False
    """whether the run may replace existing files; a command that continues it may then, too"""

    def continue_or_replay_command(
        self, report: Path | None = None, render: Path | None = None
    ) -> str | None:
        """Return the `argo` command that continues the run, or shows its recording again.

        Args:
            report: folder of a report that the command is to write
            render: file of a film that the command is to write

        Returns:
            The command line; None if neither the journal nor the recording exists.
        """
        if self._has_journal:
            words = ["argo", "resume", str(self.journal)]
        elif self.recording is not None and os.path.exists(self.recording):
            words = ["argo", "replay", str(self.recording)]
        else:
            return None
        for option, path in (("--report", report), ("--render", render)):
            if path is not None:
                words += [option, str(path)]
        if self.force and (report or render):
            words.append("--force")
        return shlex.join(words)

    @property
    def _has_journal(self) -> bool:
        return self.journal is not None and os.path.exists(self.journal)

    def continuation_or_loss_text(self, report: Path | None, render: Path | None) -> str:
        """Return a clause that says how to continue a run, or that it can't be continued."""
        command = self.continue_or_replay_command(report, render)
        if self._has_journal:
            return f"continue with: {command}"
        lost = "the run can't be continued, as no journal (--report or --journal) stores it"
        return f"{lost}; to see the results so far: {command}" if command else lost


def require_no_unfinished_run(report: Path | None, journal: Path | None = None) -> None:
    """Raise Conflict if a journal holds a run that has not ended and can be continued.

    Args:
        report: folder of a report, which may hold a journal
        journal: the journal that is named
    """
    for path in (journal, report and report / JOURNAL):
        if path and os.path.isfile(path) and _is_unfinished(path):
            raise Conflict(
                f"{path} holds a run that has not ended: choose another path, replace the run "
                "(--force), or continue it with: "
                f"{RunStorage(path).continue_or_replay_command(report)}"
            )


def _is_unfinished(path: Path) -> bool:
    try:
        with open_journal(path) as book:
            return not book.had_ended_when_opened
    except Invalid:  # no journal, or a damaged one
        return False


def is_report_of(book: Journal, folder: Path) -> bool:
    """Return True if the report in a folder is of the journal's run.

    The result is also False if the report contains more of the run than the journal does, because
    a new report would lose that. Raises Unavailable if the report is damaged.
    """
    try:
        path = folder / RECORD
        record = read_checked(RunRecord, path.read_bytes(), path, _REMEDY)
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
        and (book.had_ended_when_opened or not record.result.ended)
    )


def find_own_report(book: Journal, journal: Path) -> Path | None:
    """Return the folder of a journal if the run's report is to be written there, else None.

    `argo run --report` keeps the journal in the report's folder, which has nothing else then but
    the report, films and recordings. A report that is complete or of another run is not replaced.
    Raises Unavailable if the report is damaged.
    """
    folder = journal.parent
    others = {name for name in os.listdir(folder) if os.path.splitext(name)[1] not in _RECORDED}
    if journal.name != JOURNAL or not others <= {JOURNAL, *REPORT_FILES}:
        return None
    if not others & set(REPORT_FILES):
        return folder
    is_complete = book.had_ended_when_opened and PAGE in others
    return folder if is_report_of(book, folder) and not is_complete else None
