"""Summaries of plan files for lists, read without a full check and without repairs."""

import os
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Any

from argo_compiler.base.errors import ArgoError, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_env.files.checked_lines import parse_lines
from argo_planner.service.storage.plan_file import (
    parse_first_line,
    read_plan_bytes_or_raise,
    replaced_file_path,
)


class PlanSummary(Worded):
    """Summary of a mission plan, for lists."""

    id: str
    name: str
    created: datetime | None = None
    changed: datetime | None = None
    revision: int = 0
    tasks: int = 0
    checkpoints: tuple[str, ...] = ()
    """checkpoints that it measures, each once, sorted"""
    folder: str = ""
    """folder of the list that it is in; empty: none"""
    least_time: float | None = None
    """least duration over all executions, in s; None: not known without opening the mission"""
    most_time: float | None = None
    """greatest duration, likewise; None: not known, or it has no limit"""
    problem: Text | None = None
    """why the plan can't be opened; None: it can be opened"""
    problem_wording: Wording | None = wording_field("problem")


def read_plan_summary(path: Path) -> PlanSummary:
    """Return the summary of a plan's file, from its lines up to the first damaged one.

    If the first line is damaged, the file that this one has replaced is read instead. If nothing
    can be read as a plan, and only then, the summary's `problem` states why. Raises NotFound if
    there is no such file.
    """
    try:
        summary = _summarize(path, read_plan_bytes_or_raise(path))
        if summary is None and os.path.exists(previous := replaced_file_path(path)):
            summary = _summarize(path, read_plan_bytes_or_raise(previous))
    except NotFound:
        raise
    except ArgoError as error:
        return PlanSummary(id=path.stem, name=path.stem, problem=str(error))
    if summary is None:
        problem = Message("{path} is damaged from its first line on", path=path.name)
        return PlanSummary(id=path.stem, name=path.stem, problem=problem)
    return summary


def _summarize(path: Path, content: bytes) -> PlanSummary | None:
    lines = parse_lines(content).objects
    base = parse_first_line(path, content.partition(b"\n")[0]) if lines else None
    if base is None:
        return None
    try:
        tasks = {task["name"]: task.get("object_id") for task in base["mission"]["tasks"]}
        fields = {key: base[key] for key in ("name", "created", "changed", "revision")}
        fields["folder"] = base.get("folder", "")
        for line in lines[1:]:
            _apply_record(line.data, tasks, fields)
        measured = measured_checkpoints(tasks.values())
        return PlanSummary(id=path.stem, **fields, tasks=len(tasks), checkpoints=measured)
    except (KeyError, TypeError, ValueError):
        return None  # written by another program


def measured_checkpoints(ids: Iterable[str | None]) -> tuple[str, ...]:
    """Return the checkpoints among the ids of tasks, sorted by number; None: it measures none."""
    return tuple(sorted({one for one in ids if one is not None}, key=lambda one: (len(one), one)))


def _apply_record(
    record: dict[str, Any], tasks: dict[str, str | None], fields: dict[str, Any]
) -> None:
    """Update the checkpoints of the tasks, by name, and the fields of a summary by a record."""
    if record["kind"] == "revision":
        revision = record["revision"]
        fields |= {"revision": revision["number"], "changed": revision["at"]}
        change = revision["change"].get("tasks") or {}
        for name in change.get("gone", ()):
            tasks.pop(name, None)
        tasks.update((task["name"], task.get("object_id")) for task in change.get("put", ()))
    elif record["kind"] == "renamed":
        fields |= {"name": record["name"], "changed": record["at"]}
    elif record["kind"] == "filed":
        fields |= {"folder": record["folder"]}
