"""A digest of the code that plans on sites: what it has found is only good for the same code."""

import hashlib
import struct
import sys
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

_ROOT = Path(__file__).parents[2]
_FOLDERS = ("files", "navigation", "planning", "robot", "site")
_MODULES = (
    "argo_compiler/base/catalog.py",
    "argo_compiler/base/model.py",
    "argo_compiler/analysis/step_costs.py",
)


@lru_cache(maxsize=1)
def digest_of_code() -> str:
    """Of all modules that have a part in what is found on a site, of the libraries that search for
    it, and of the kind of machine."""
    sink = hashlib.blake2b(digest_size=16)
    sink.update(f"{sys.platform} {sys.byteorder} {struct.calcsize('P')} ".encode())
    libraries = f"{_version_of('numpy')} {_version_of('scipy')}"
    sink.update(f"{sys.version_info[:2]} {libraries}".encode())
    files = [_ROOT / module for module in _MODULES]
    for folder in _FOLDERS:
        files += sorted((_ROOT / "argo_env" / folder).glob("*.py"))
    for file in files:
        sink.update(file.relative_to(_ROOT).as_posix().encode())
        sink.update(file.read_bytes())
    return sink.hexdigest()


def _version_of(library: str) -> str:
    """Return the text with its version, without importing it, which takes longer than all else."""
    found = find_spec(library)
    if found is None or found.origin is None:
        return "none"
    version = Path(found.origin).with_name("version.py")
    return version.read_text(encoding="utf-8") if version.is_file() else found.origin
