"""What was understood of a mission, said back in plain sentences: task by task, with what was
assumed, what has no effect, and what was warned of.

The text is a script itself: what is no sentence of the mission stands in remarks.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, Severity, Span
from argo_compiler.il import Action, Condition, ConditionType, Group, Mission, Task
from argo_compiler.script.write.protocol import lines_of, parts_said
from argo_compiler.script.write.steps import Said
from argo_compiler.script.write.text import INDENT, number, wrapped

_NO_EFFECT = frozenset(
    [
        *("script.comment", "script.no-effect", "script.set-aside", "script.set-aside-by-hand"),
        "script.order-taken",
    ]
)
_ASSUMING = frozenset(
    [
        *("script.decided", "script.dock-assumed", "script.title", "script.healed"),
        *("script.once-more", "script.priority-taken", "script.quantity", "script.respelled"),
        "script.unclear-cut",
    ]
)
"""findings of what was taken though the script does not say it so"""


class PartSaid(StrEnum):
    """What an entry of a reading is about."""

    HEADER = "header"
    TASK = "task"
    ROUND = "round"
    ORDER = "order"
    """what has to come before what"""
    REACTION = "reaction"


class ReadingEntry(Model):
    """What is said of one part of the mission."""

    part: PartSaid
    name: str = ""
    """of the task, the round or the event"""
    step: int | None = None
    """the number of the sentence among the steps"""
    sentences: tuple[str, ...]
    meaning: tuple[str, ...] = ()
    """which checkpoint a number is, and which values are normal there"""
    assumed: tuple[str, ...] = ()
    """what was taken though the script does not say it so"""
    source: Span | None = None
    """where the script asks for it"""


class MissionReading(Model):
    """A mission in plain sentences."""

    source_name: str
    text: str
    """all of it as a script, in which the marks stand in remarks"""
    entries: tuple[ReadingEntry, ...]
    assumed: tuple[str, ...] = ()
    """what was assumed of the mission as a whole"""
    no_effect: tuple[Diagnostic, ...] = ()
    """what the script says that changes nothing"""
    warnings: tuple[Diagnostic, ...] = ()


def read_back(
    mission: Mission,
    catalog: Catalog,
    diagnostics: Iterable[Diagnostic] = (),
    source_name: str = "mission",
) -> MissionReading:
    """The reading of a mission, with what its import and its checks said of it.

    Raises DiagnosticError if the script language can't say the mission.
    """
    found = tuple(diagnostics)
    assuming = [d for d in found if d.code in _ASSUMING]
    by_line: dict[int, list[str]] = defaultdict(list)
    for one in assuming:
        if one.span is not None:
            by_line[one.span.line].append(one.message)
    header, steps, others = parts_said(mission, catalog)
    entries = [ReadingEntry(part=PartSaid.HEADER, sentences=(_plain(line),)) for line in header]
    lines = [line for field in header for line in wrapped(field)]
    for part in (steps, others):
        lines += [""] if part else []
        for said in part:
            line = said.source.line if said.source is not None else 0
            entries.append(_entry(said, catalog, by_line.pop(line, [])))
            lines += [*lines_of([said]), *_marks(entries[-1])]
    reading = MissionReading(
        source_name=source_name,
        text="",
        entries=tuple(entries),
        assumed=tuple(message for messages in by_line.values() for message in messages),
        no_effect=tuple(d for d in found if d.code in _NO_EFFECT),
        warnings=tuple(
            d
            for d in found
            if d.severity is Severity.WARNING and d.code not in _ASSUMING | _NO_EFFECT
        ),
    )
    text = "\n".join([*lines, *_last_marks(reading)]) + "\n"
    return reading.model_copy(update={"text": text})


def _entry(said: Said, catalog: Catalog, assumed: Sequence[str]) -> ReadingEntry:
    kind, _, name = said.subject.partition("[")
    part = {"groups": PartSaid.ROUND, "reactions": PartSaid.REACTION, "before": PartSaid.ORDER}.get(
        kind
    )
    return ReadingEntry(
        part=part or PartSaid.TASK,
        name=said.about[0].name if said.about else name.strip("]'\""),
        step=said.number,
        sentences=tuple(map(_plain, said.sentences)),
        meaning=tuple(_meaning(said.about, catalog)),
        assumed=tuple(assumed),
        source=said.source,
    )


def _plain(sentence: str) -> str:
    return sentence.replace("\n", " ")


def _meaning(about: Iterable[Task | Group], catalog: Catalog) -> Iterator[str]:
    """Which checkpoint each number is that is named, and what is normal where that is asked."""
    numbers: dict[str, bool] = {}
    for part in about:
        if isinstance(part, Task) and part.action is Action.MEASURE and part.object_id:
            numbers[part.object_id] = False
        for condition in _conditions(part):
            abnormal = condition.type is ConditionType.ABNORMAL
            numbers[condition.object_id] = numbers.get(condition.object_id, False) or abnormal
    for known, abnormal in numbers.items():
        checkpoint = catalog.checkpoint(int(known)) if known.isdecimal() else None
        if checkpoint is None:
            continue
        said = f"#{known} is {checkpoint.name} on floor {checkpoint.floor}"
        if abnormal:
            low, high = number(checkpoint.nominal.low), number(checkpoint.nominal.high)
            said += f"; abnormal is less than {low} or more than {high} {checkpoint.unit}"
        yield said


def _conditions(part: Task | Group) -> Iterator[Condition]:
    if isinstance(part, Group):
        yield from part.until
        return
    for transition in part.transitions:
        yield from transition.conditions
    if part.wait is not None:
        yield from part.wait.conditions


def _marks(entry: ReadingEntry) -> Iterator[str]:
    for said in entry.meaning:
        yield f"{INDENT}Note: {_remark(said)}"
    for said in entry.assumed:
        yield f"{INDENT}Note: assumed: {_remark(said)}"


def _last_marks(reading: MissionReading) -> list[str]:
    found = [f"Note: assumed: {_remark(said)}" for said in reading.assumed]
    found += [f"Note: no effect: {_remark(_placed(d))}" for d in reading.no_effect]
    found += [f"Note: warning: {_remark(_placed(d))}" for d in reading.warnings]
    return ["", *found] if found else []


def _placed(diagnostic: Diagnostic) -> str:
    where = f"line {diagnostic.span.line}: " if diagnostic.span is not None else ""
    return f"{where}{diagnostic.message}"


def _remark(text: str) -> str:
    """The text in one line, without what could begin anything else."""
    return " ".join(text.split())[:1_000]
