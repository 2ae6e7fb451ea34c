"""The record of a run on the terminal."""

from collections.abc import Iterator

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_env.formatting import clock, where
from argo_env.report.waiting import waits
from argo_env.run.record import RunRecord


def show_record(record: RunRecord, console: Console) -> None:
    """Prints what was measured, what each task took, the contacts and the verdict."""
    console.print(_readings(record))
    console.print(_tasks(record))
    result = record.result
    limit = f" of at most {clock(result.max_duration)}" if result.max_duration else ""
    touches = f"{len(record.contacts)} contact{'s' if len(record.contacts) != 1 else ''}"
    found = len(record.findings)
    findings = f"{found} finding{'s' if found != 1 else ''}, " if found else ""
    docked = {True: "docked", False: "not docked", None: "no docking asked for"}[result.docked]
    console.print(
        f"{clock(result.duration)}{limit}, {result.distance:.1f} m, "
        f"{result.climbed:.1f} m climbed, {touches}, {findings}{docked}",
        soft_wrap=True,
    )
    for contact in record.contacts[:10]:
        console.print(
            f"  contact at {clock(contact.start)}: {escape(contact.link)} with "
            f"{escape(contact.element)}, {contact.depth * 1000:.0f} mm deep",
            style="red",
            soft_wrap=True,
        )
    for mishap in record.mishaps[:10]:
        console.print(
            f"  {mishap.trouble} at {clock(mishap.t)} on {where(mishap.floor, mishap.place)}: "
            f"{escape(mishap.detail)}",
            style="yellow",
            soft_wrap=True,
        )
    for fault in record.missed_faults:
        console.print(f"  {escape(record.why_missed(fault))}", style="yellow", soft_wrap=True)
    style, word = ("bold green", "Success") if result.success else ("bold red", "No success")
    console.print(f"[{style}]{word}[/]: {escape(result.verdict)}.", soft_wrap=True)


def _readings(record: RunRecord) -> Table:
    table = Table(title="Readings", title_justify="left")
    for name, side in (
        ("#", "right"), ("checkpoint", "left"), ("floor", "right"), ("at", "right"),
        ("value", "right"), ("nominal", "right"), ("", "left"),
    ):  # fmt: skip
        table.add_column(name, justify="right" if side == "right" else "left")
    for reading in record.readings:
        table.add_row(
            str(reading.checkpoint),
            escape(reading.name),
            str(reading.floor),
            clock(reading.t),
            f"{reading.value:.2f} {reading.unit}",
            f"{reading.nominal.low:g} to {reading.nominal.high:g}",
            "[green]normal[/]" if reading.normal else "[bold red]abnormal[/]",
        )
    return table


def _tasks(record: RunRecord) -> Table:
    """One row for each task and for what was waited for, in the order in which they first began;
    repeated ones are taken together."""
    table = Table(title="Tasks", title_justify="left")
    table.add_column("task")
    for name in ("times", "first at", "time", "distance", "climbed"):
        table.add_column(name, justify="right")
    table.add_column("outcome")
    rows = [*_task_rows(record), *_wait_rows(record)]
    for _, row in sorted(rows, key=lambda timed: timed[0]):
        table.add_row(*row)
    return table


def _task_rows(record: RunRecord) -> Iterator[tuple[float, tuple[str, ...]]]:
    """The rows with the times (s) of the first begins."""
    for name in dict.fromkeys(t.task for t in record.tasks):
        runs = [t for t in record.tasks if t.task == name]
        outcomes = dict.fromkeys(t.outcome for t in runs)
        reasons = dict.fromkeys(t.reason for t in runs if t.reason)
        yield (
            runs[0].start,
            (
                escape(name),
                str(len(runs)),
                clock(runs[0].start),
                clock(sum(t.end - t.start for t in runs)),
                f"{sum(t.distance for t in runs):.1f} m",
                f"{sum(t.climbed for t in runs):.1f} m",
                escape(", ".join(outcomes) + (f" ({'; '.join(reasons)})" if reasons else "")),
            ),
        )


def _wait_rows(record: RunRecord) -> Iterator[tuple[float, tuple[str, ...]]]:
    """The rows with the times (s) of the first begins."""
    found = waits(record)
    for what in dict.fromkeys(wait.what for wait in found):
        same = [wait for wait in found if wait.what == what]
        yield (
            same[0].start,
            (
                escape(f"waits for {what}"),
                str(len(same)),
                clock(same[0].start),
                clock(sum(wait.end - wait.start for wait in same)),
                "",
                "",
                "over" if same[-1].over else "still waiting at the end",
            ),
        )
