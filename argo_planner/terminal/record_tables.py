"""Tables and lines on the terminal for the record of a run."""

from collections.abc import Iterator

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_env.formatting import floor_and_position_text, min_sec_text
from argo_env.report.rounds import all_waits
from argo_env.run.causes import explain_false_all_clear, false_all_clears
from argo_env.run.record import RunRecord, WindowOutcome
from argo_env.run.verdict_line import Tone
from argo_env.site import Site

_WIDE = 100
"""width in characters from which a terminal shows the column with measuring times"""
_STYLES = {Tone.GOOD: "bold green", Tone.NOTICE: "bold yellow", Tone.BAD: "bold red"}


def show_record(record: RunRecord, site: Site, console: Console) -> None:
    """Print the readings, the tasks, findings and contacts, and the verdict."""
    console.print(_readings(record))
    measuring = console.width >= _WIDE and any(t.measuring_duration for t in record.tasks)
    console.print(_tasks(record, measuring))
    result = record.result
    limit = f" of at most {min_sec_text(result.max_duration)}" if result.max_duration else ""
    touches = f"{len(record.contacts)} contact{'s' if len(record.contacts) != 1 else ''}"
    not_docked = "not docked" if result.ended else "not docked yet"
    docked = {True: "docked", False: not_docked, None: "docking not required"}[result.docked]
    console.print(
        f"{min_sec_text(result.duration)}{limit}, {result.distance:.1f} m, "
        f"{result.climbed:.1f} m climbed, {touches}, {docked}",
        soft_wrap=True,
    )
    for line in _problem_lines(record, site):
        console.print(f"  {escape(line)}", style="yellow", soft_wrap=True)
    headline = record.headline
    console.print(
        f"[{_STYLES[headline.tone]}]{headline.word}[/]: {escape(headline.text)}.", soft_wrap=True
    )


def _problem_lines(record: RunRecord, site: Site) -> Iterator[str]:
    """Yield a line for each finding, false all-clear, contact, mishap and fault not begun."""
    for finding in record.findings:
        detail = "" if finding.is_reading or not finding.detail else f": {finding.detail}"
        yield ", ".join(filter(None, (finding.in_words, finding.whereabouts))) + detail
    yield from map(explain_false_all_clear, false_all_clears(record, site))
    for contact in record.contacts:
        yield (
            f"contact at {min_sec_text(contact.start)}: {contact.link} with {contact.element}, "
            f"{contact.depth * 1000:.0f} mm deep"
        )
    for mishap in record.mishaps:
        place = floor_and_position_text(mishap.floor, mishap.place)
        yield f"{mishap.trouble} at {min_sec_text(mishap.t)} on {place}: {mishap.detail}"
    for fault in record.faults_not_begun:
        yield record.explain_fault_not_begun(fault)


def _readings(record: RunRecord) -> Table:
    table = Table(title="Readings", title_justify="left")
    for name in ("#", "checkpoint", "floor", "at", "value", "nominal", ""):
        table.add_column(name, justify="left" if name in ("checkpoint", "") else "right")
    for reading in record.readings:
        table.add_row(
            str(reading.checkpoint),
            escape(reading.name),
            str(reading.floor),
            min_sec_text(reading.t),
            f"{reading.value:.2f} {reading.unit}",
            f"{reading.nominal.low:g} to {reading.nominal.high:g}",
            "[green]normal[/]" if reading.normal else "[bold red]abnormal[/]",
        )
    return table


def _tasks(record: RunRecord, measuring: bool) -> Table:
    """Return a table with a row for each task and each kind of wait, in order of their first start.

    Repetitions share a row. With `measuring`, a column shows how long the robot measured.
    """
    table = Table(title="Tasks", title_justify="left")
    table.add_column("task")
    names = ("times", "first at", "time", *(["measuring"] if measuring else []))
    for name in (*names, "distance", "climbed"):
        table.add_column(name, justify="right")
    table.add_column("outcome")
    rows = [*_task_rows(record), *_wait_rows(record)]
    for _, row in sorted(rows, key=lambda timed: timed[0]):
        table.add_row(*row[:4], *(row[4:5] if measuring else ()), *row[5:])
    return table


def _task_rows(record: RunRecord) -> Iterator[tuple[float, tuple[str, ...]]]:
    """Yield the rows of tasks, each with the time in s of its first start."""
    missed = _missed(record)
    for name in dict.fromkeys([*(t.task for t in record.tasks), *(name for name, _ in missed)]):
        runs = [t for t in record.tasks if t.task == name]
        begins = [t.start for t in runs] + [at for task, at in missed if task == name]
        outcomes = dict.fromkeys(t.outcome_in_words for t in runs)
        if len(begins) > len(runs):
            outcomes["missed"] = None
        reasons = dict.fromkeys(t.reason for t in runs if t.reason)
        yield (
            min(begins),
            (
                escape(name),
                str(len(begins)),
                min_sec_text(min(begins)),
                min_sec_text(sum(t.end - t.start for t in runs)),
                min_sec_text(measured)
                if (measured := sum(t.measuring_duration for t in runs))
                else "",
                f"{sum(t.distance for t in runs):.1f} m",
                f"{sum(t.climbed for t in runs):.1f} m",
                escape(", ".join(outcomes) + (f" ({'; '.join(reasons)})" if reasons else "")),
            ),
        )


def _missed(record: RunRecord) -> list[tuple[str, float]]:
    """Return the tasks that were reached after their window, with the times (s) of reaching them.

    In such a visit no action ran.
    """
    waited = {wait.task for wait in record.waits}
    return [
        (one.task, one.visited)
        for one in record.windows
        if one.kept is WindowOutcome.MISSED and one.visited is not None and one.task not in waited
        if not any(t.task == one.task and one.visited <= t.start for t in record.tasks)
    ]


def _wait_rows(record: RunRecord) -> Iterator[tuple[float, tuple[str, ...]]]:
    """Yield the rows of waits, each with the time in s of its first start."""
    found = all_waits(record)
    for what in dict.fromkeys(wait.what for wait in found):
        same = [wait for wait in found if wait.what == what]
        yield (
            same[0].start,
            (
                escape(f"waits for {what}"),
                str(len(same)),
                min_sec_text(same[0].start),
                min_sec_text(sum(wait.end - wait.start for wait in same)),
                "",
                "",
                "",
                escape("; ".join(dict.fromkeys(wait.outcome for wait in same))),
            ),
        )
