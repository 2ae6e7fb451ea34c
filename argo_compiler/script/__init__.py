"""The script front end: text as people write it becomes a mission, and a mission becomes text."""

from argo_compiler.script.resolve.importing import Resolved, import_script, resolve_script
from argo_compiler.script.syntax.parsing import parse
from argo_compiler.script.syntax.reading import decode_script, read_script
from argo_compiler.script.write.protocol import format_script

__all__ = [
    "Resolved",
    "decode_script",
    "format_script",
    "import_script",
    "parse",
    "read_script",
    "resolve_script",
]
