"""A digest of the code that plans on sites: its cached results are only valid for the same code."""

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
def code_digest() -> str:
    """Return a digest of the code and libraries that plan on sites, and of the kind of machine."""
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
    """Return the text of a library's `version.py`, else its path; "none" if it is not installed.

    The library is not imported, as that would take longer than everything else.
    """
    spec = find_spec(library)
    if spec is None or spec.origin is None:
        return "none"
    version = Path(spec.origin).with_name("version.py")
    return version.read_text(encoding="utf-8") if version.is_file() else spec.origin
