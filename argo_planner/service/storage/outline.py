"""What a list shows of a plan's file, read without opening it: nothing is checked or mended."""

import os
from datetime import datetime
from pathlib import Path
from typing import Any

from argo_compiler.base.errors import ArgoError, NotFound
from argo_compiler.base.model import Model
from argo_env.files.checked_lines import checked_object
from argo_planner.service.storage.plan_file import base_object, earlier_file, plan_content


class PlanSummary(Model):
    """What a list of plans shows of each."""

    id: str
    name: str
    created: datetime | None = None
    changed: datetime | None = None
    revision: int = 0
    tasks: int = 0
    problem: str | None = None
    """why it can't be opened, if it can't"""


def read_outline(path: Path) -> PlanSummary:
    """The summary of a file as far as its lines are good. Where it can't be opened as a plan, its
    `problem` says why. Raises NotFound if there is no such file."""
    try:
        found = _outline(path.stem, plan_content(path))
        if found is None and os.path.exists(earlier := earlier_file(path)):
            found = _outline(path.stem, plan_content(earlier))
    except NotFound:
        raise
    except ArgoError as error:
        return PlanSummary(id=path.stem, name=path.stem, problem=str(error))
    if found is None:
        said = f"{path.name}: is damaged from its first line on"
        return PlanSummary(id=path.stem, name=path.stem, problem=said)
    return found


def _outline(id: str, content: bytes) -> PlanSummary | None:
    lines = content.split(b"\n")[:-1]
    base = base_object(lines[0]) if lines else None
    if base is None:
        return None
    try:
        tasks = {task["name"] for task in base["mission"]["tasks"]}
        told = {key: base[key] for key in ("name", "created", "changed", "revision")}
        for number, line in enumerate(lines[1:], start=1):
            record = checked_object(line)
            if record is None or record.get("n") != number:
                break
            _follow(record, tasks, told)
        return PlanSummary(id=id, **told, tasks=len(tasks))
    except (KeyError, TypeError, ValueError):
        return None  # another program has written it


def _follow(record: dict[str, Any], tasks: set[str], told: dict[str, Any]) -> None:
    """Takes what a record changes of an outline."""
    if record["kind"] == "revision":
        made = record["revision"]
        told |= {"revision": made["number"], "changed": made["at"]}
        change = made["change"].get("tasks") or {}
        tasks.difference_update(change.get("gone", ()))
        tasks.update(task["name"] for task in change.get("put", ()))
    elif record["kind"] == "renamed":
        told |= {"name": record["name"], "changed": record["at"]}
