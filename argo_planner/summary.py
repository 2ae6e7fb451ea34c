"""The record of a run on the terminal."""

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_env.record import Interruption, RunRecord

MOMENT = 0.5
"""s, up to which standing still is no waiting"""


def show_record(record: RunRecord, console: Console) -> None:
    """Prints what was measured, what each task took, the contacts and the verdict."""
    console.print(_readings(record))
    console.print(_tasks(record))
    result = record.result
    limit = f" of at most {clock(result.max_duration)}" if result.max_duration else ""
    touches = f"{len(record.contacts)} contact{'s' if len(record.contacts) != 1 else ''}"
    found = len(record.anomalies)
    findings = f"{found} finding{'s' if found != 1 else ''}, " if found else ""
    docked = {True: "docked", False: "not docked", None: "no docking asked for"}[result.docked]
    console.print(
        f"{clock(result.duration)}{limit}, {result.distance:.1f} m, "
        f"{result.climbed:.1f} m climbed, {touches}, {findings}{docked}"
    )
    for contact in record.contacts[:10]:
        console.print(
            f"  contact at {clock(contact.start)}: {escape(contact.link)} with "
            f"{escape(contact.element)}, {contact.depth * 1000:.0f} mm deep",
            style="red",
        )
    for mishap in record.mishaps[:10]:
        x, y, z = mishap.place
        console.print(
            f"  {mishap.trouble} at {clock(mishap.t)} on floor {mishap.floor}, at "
            f"({x:.2f}, {y:.2f}, {z:.2f}): {escape(mishap.detail)}",
            style="yellow",
        )
    for fault in record.missed_faults:
        console.print(
            f"  fault {fault.kind.replace('_', ' ')} did not happen: begins at {fault.begins:g} s, "
            f"the mission ended at {round(result.duration, 1):g} s",
            style="yellow",
        )
    style, word = ("bold green", "Success") if result.success else ("bold red", "No success")
    console.print(f"[{style}]{word}[/]: {escape(result.verdict)}.")


def clock(seconds: float) -> str:
    """Minutes and seconds, such as 4:59."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


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
    """One row for each task, repeated executions taken together; then what the robot waited for."""
    table = Table(title="Tasks", title_justify="left")
    table.add_column("task")
    for name in ("times", "first at", "time", "distance", "climbed"):
        table.add_column(name, justify="right")
    table.add_column("outcome")
    for name in dict.fromkeys(t.task for t in record.tasks):
        runs = [t for t in record.tasks if t.task == name]
        outcomes = dict.fromkeys(t.outcome for t in runs)
        reasons = dict.fromkeys(t.reason for t in runs if t.reason)
        table.add_row(
            escape(name),
            str(len(runs)),
            clock(runs[0].start),
            clock(sum(t.end - t.start for t in runs)),
            f"{sum(t.distance for t in runs):.1f} m",
            f"{sum(t.climbed for t in runs):.1f} m",
            escape(", ".join(outcomes) + (f" ({'; '.join(reasons)})" if reasons else "")),
        )
    for what, waits in _waiting(record).items():
        goes_on = waits[-1][1] >= record.result.duration
        table.add_row(
            escape(f"waits for {what}"),
            str(len(waits)),
            clock(waits[0][0]),
            clock(sum(end - start for start, end in waits)),
            "",
            "",
            "still waiting at the end" if goes_on else "over",
        )
    return table


def _waiting(record: RunRecord) -> dict[str, list[tuple[float, float]]]:
    """When (s) the robot stood still in pauses and reactions, by what it waited for and why."""
    found: dict[str, list[tuple[float, float]]] = {}
    until = {reaction.event: reaction.until for reaction in record.mission.reactions}
    before: Interruption | None = None
    for each in record.interruptions:
        runs = [t.end for t in record.tasks if t.start < each.end and t.end > each.start]
        since = max([each.start, *runs])
        # A run that is stopped as soon as nothing more can come has waited no time.
        if each.end - since >= MOMENT or (record.result.outcome is None and each is _last(record)):
            awaited = until.get(each.event) if each.event else None
            cause = each.cause
            if each.event is None and before and before.event and before.end == each.start:
                cause = before.cause  # which has ended in this pause
            words = f"{awaited.replace('_', ' ') if awaited else 'a person'} ({cause})"
            found.setdefault(words, []).append((since, each.end))
        before = each
    return found


def _last(record: RunRecord) -> Interruption | None:
    """The interruption that went on when the run was stopped."""
    last = record.interruptions[-1]
    return last if last.end >= record.result.duration else None
