"""Recognition of isar's definitions, without what reads them."""

import json
from typing import Any

from argo_compiler.files.loading import FileError, decode_text
from argo_compiler.files.mission_file import MAX_BYTES

INSPECTION = "inspection"
RETURN_TO_HOME = "return_to_home"
"""kinds of its tasks"""
WRAPPED = "mission_definition"
"""what isar's API calls the definition in the body of a request"""


def find_definition(content: bytes) -> dict[str, Any] | None:
    """Return the data of a file with an isar definition; None if it is no such file."""
    # Argo's own missions can be large: they are not read twice for having these words in them.
    try:
        text = "" if len(content) > MAX_BYTES else decode_text(content, "", "mission")
        if not any(f'"{word}"' in text for word in (INSPECTION, RETURN_TO_HOME, WRAPPED)):
            return None
        data = json.loads(text)
    except (FileError, ValueError, RecursionError):
        return None  # the reader of missions says what is wrong with the file
    return data if _is_definition(data) else None


def _is_definition(data: Any) -> bool:
    """Return True if this is meant as isar's and not as Argo's, whose tasks have actions."""
    if not isinstance(data, dict) or "version" in data:
        return False
    definition = data.get(WRAPPED, data)
    tasks = definition.get("tasks") if isinstance(definition, dict) else None
    return isinstance(tasks, list) and any(
        isinstance(task, dict) and "action" not in task and "pose" in task for task in tasks
    )
