"""The script front end: text as people write it becomes a mission, and a mission becomes text."""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "Resolved",
    "decode_script",
    "format_script",
    "import_script",
    "parse",
    "read_script",
    "resolve_script",
]

if TYPE_CHECKING:
    from argo_compiler.script.documents.reading import decode_script, read_script
    from argo_compiler.script.parsing.parser import parse
    from argo_compiler.script.resolve.importing import Resolved, import_script, resolve_script
    from argo_compiler.script.write.protocol import format_script
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "resolve.importing": ["Resolved", "import_script", "resolve_script"],
            "parsing.parser": ["parse"],
            "documents.reading": ["decode_script", "read_script"],
            "write.protocol": ["format_script"],
        },
    )
