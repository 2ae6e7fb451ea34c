"""The script front end: a mission sheet or a mission protocol becomes a mission.

`read_script` reads the file, `heal` takes the noise of text recognition out, `parse` makes the
syntax tree, `resolve` looks up what it names and makes the mission; `import_script` does the last
three in one. `format_script` writes a mission back as a protocol.
"""

from argo_compiler.script.resolve.importing import Resolved, import_script, resolve
from argo_compiler.script.syntax.healing import Healed, heal
from argo_compiler.script.syntax.nodes import Protocol, Script, Sheet
from argo_compiler.script.syntax.parsing import parse
from argo_compiler.script.syntax.reading import decode_script, read_script
from argo_compiler.script.syntax.vocabulary import catalog_words
from argo_compiler.script.write.protocol import format_script

__all__ = [
    "Healed",
    "Protocol",
    "Resolved",
    "Script",
    "Sheet",
    "catalog_words",
    "decode_script",
    "format_script",
    "heal",
    "import_script",
    "parse",
    "read_script",
    "resolve",
]
