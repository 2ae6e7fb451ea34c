"""The script front end: text as people write it becomes a mission, and a mission becomes text."""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "Act",
    "Document",
    "Draft",
    "DraftActs",
    "DraftLine",
    "DurationReading",
    "IncompleteDraft",
    "LineDecision",
    "LineState",
    "Resolved",
    "StoredDraft",
    "decode_document",
    "decode_script",
    "draft_text",
    "format_script",
    "import_script",
    "parse",
    "read_decisions",
    "read_document",
    "read_draft",
    "read_duration",
    "read_script",
    "resolve_script",
]

if TYPE_CHECKING:
    from argo_compiler.script.documents.document import Document
    from argo_compiler.script.documents.reading import (
        decode_document,
        decode_script,
        read_document,
        read_script,
    )
    from argo_compiler.script.drafts.draft import (
        Act,
        Draft,
        DraftActs,
        DraftLine,
        IncompleteDraft,
        LineDecision,
        LineState,
    )
    from argo_compiler.script.drafts.draft_file import (
        StoredDraft,
        draft_text,
        read_decisions,
        read_draft,
    )
    from argo_compiler.script.drafts.making import import_script
    from argo_compiler.script.durations import DurationReading, read_duration
    from argo_compiler.script.parsing.parser import parse
    from argo_compiler.script.resolve.importing import Resolved, resolve_script
    from argo_compiler.script.write.protocol import format_script
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "documents.document": ["Document"],
            "documents.reading": [
                "decode_document",
                "decode_script",
                "read_document",
                "read_script",
            ],
            "drafts.draft": [
                "Act",
                "Draft",
                "DraftActs",
                "DraftLine",
                "IncompleteDraft",
                "LineDecision",
                "LineState",
            ],
            "drafts.draft_file": ["StoredDraft", "draft_text", "read_decisions", "read_draft"],
            "drafts.making": ["import_script"],
            "durations": ["DurationReading", "read_duration"],
            "parsing.parser": ["parse"],
            "resolve.importing": ["Resolved", "resolve_script"],
            "write.protocol": ["format_script"],
        },
    )
