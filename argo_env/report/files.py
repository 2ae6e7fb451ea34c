"""Files of a report."""

import json
from pathlib import Path
from typing import Any

from argo_compiler.base.errors import Conflict
from argo_compiler.files.atomic_write import write_files_atomically
from argo_env.files.checked_files import checked_json, checked_page
from argo_env.files.folders import reporting_write_errors
from argo_env.report.html import page
from argo_env.run.record import RunRecord
from argo_env.site import Site

RECORD = "report.json"
PAGE = "report.html"
"""file of a report that a person opens"""


def write_report(record: RunRecord, site: Site, folder: Path) -> Path:
    """Write `report.json` and `report.html` into the folder and return the path of the page.

    Equal records give the same bytes. `RunRecord.model_validate_json` reads the JSON again.
    Raises ArgoError if the record belongs to another site, or the files can't be written.
    """
    if record.site != site.name:
        raise Conflict(
            f"the record is of a run on site `{record.site}`, not on `{site.name}`: load that site"
        )
    texts = {RECORD: checked_json(to_json(record)), PAGE: checked_page(page(record, site))}
    contents = {name: text.encode() for name, text in texts.items()}
    with reporting_write_errors(folder, "the report", "; choose another folder"):
        write_files_atomically(folder, contents)
    return folder / PAGE


def to_json(record: RunRecord) -> str:
    """Return the record as JSON; each item of a list, such as a sample of the path, has a line."""
    fields = record.model_dump(mode="json", exclude=_WORDINGS)
    parts = [f'  "{name}": {_value(value)}' for name, value in fields.items()]
    return "{\n" + ",\n".join(parts) + "\n}\n"


_WORDINGS: Any = {
    "diagnostics": {"__all__": {"message_wording", "hint_wording"}},
    "tasks": {"__all__": {"reason_wording"}},
    "mishaps": {"__all__": {"detail_wording"}},
    "anomalies": {"__all__": {"detail_wording"}},
    "findings": {"__all__": {"detail_wording"}},
}
"""what a report leaves out: it is in English"""


def _value(value: object) -> str:
    if not isinstance(value, list) or not value:
        return json.dumps(value, indent=2, ensure_ascii=False).replace("\n", "\n  ")
    lines = (json.dumps(item, ensure_ascii=False) for item in value)
    return "[\n    " + ",\n    ".join(lines) + "\n  ]"
