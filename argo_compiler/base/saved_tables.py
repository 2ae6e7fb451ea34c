"""Tables that take long to make, saved beside the files that they are made of.

`make generated` writes them. Each begins with a key, a digest of all that it depends on: of another
key it is not used, and only the start takes longer.
"""

import pickle
import zlib
from collections.abc import Iterable
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

_KEY = 32
"""bytes"""


def key_of(package: str, names: Iterable[str], *besides: str) -> bytes:
    """Return the key of what is made of the files of a package, and of what else is named."""
    found = sha256(" ".join(besides).encode() + Path(__file__).read_bytes())
    for name in names:
        found.update(files(package).joinpath(name).read_bytes())
    return found.digest()


def find_tables(package: str, name: str, key: bytes) -> Any:
    """Return the tables of that name; None if there are none of this key."""
    saved = files(package).joinpath(name)
    data = saved.read_bytes() if saved.is_file() else b""
    return pickle.loads(zlib.decompress(data[_KEY:])) if data[:_KEY] == key else None


def are_saved(path: Path, key: bytes) -> bool:
    """Return whether the file has tables of this key."""
    return path.exists() and path.read_bytes()[:_KEY] == key


def write_tables(path: Path, key: bytes, tables: Any) -> None:
    """Write tables for `find_tables`."""
    path.write_bytes(key + zlib.compress(pickle.dumps(tables), 9))
