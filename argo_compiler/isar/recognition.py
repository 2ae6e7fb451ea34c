"""Recognition of isar's definitions, without importing their models."""

import json
from typing import Any

from argo_compiler.files.loading import FileError, decode_text
from argo_compiler.files.mission_file import MAX_BYTES

INSPECTION = "inspection"
RETURN_TO_HOME = "return_to_home"
"""Types of isar's tasks, with `INSPECTION`."""
WRAPPED = "mission_definition"
"""Field of a request to isar's API that contains the definition."""


def find_isar_data(content: bytes) -> dict[str, Any] | None:
    """Return all data of a file with an isar definition, or None if the file has none."""
    # Argo's own missions can be large, so they are parsed here only if they contain these words.
    try:
        text = "" if len(content) > MAX_BYTES else decode_text(content, "", "mission")
        if not any(f'"{word}"' in text for word in (INSPECTION, RETURN_TO_HOME, WRAPPED)):
            return None
        data = json.loads(text)
    except (FileError, ValueError, RecursionError):
        return None  # the reader of missions reports what is wrong with the file
    return data if _is_definition(data) else None


def _is_definition(data: Any) -> bool:
    """Return True if the data look like isar's definition and not like a mission of Argo.

    Only tasks of Argo have actions, and only those of older formats of isar have lists.
    """
    if not isinstance(data, dict) or "version" in data:
        return False
    definition = data.get(WRAPPED, data)
    tasks = definition.get("tasks") if isinstance(definition, dict) else None
    return isinstance(tasks, list) and any(
        isinstance(task, dict)
        and not {"action", "inspections", "steps"} & task.keys()
        and "pose" in task
        for task in tasks
    )
