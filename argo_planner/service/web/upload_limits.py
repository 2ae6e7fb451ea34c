"""Limits of the bytes that a request may bring: uploads, other bodies, and messages."""

from argo_compiler.files.mission_file import MAX_BYTES

MOST_UPLOADED = MAX_BYTES
"""of a mission that is imported: as much as a mission file may have, which
`argo_compiler/files/mission_file.py` says; scripts have a limit of their own as well, in
`argo_compiler/script/syntax/reading.py`"""
MOST_OF_A_BODY = 2_000_000
"""of any other request's body"""
MOST_OF_A_MESSAGE = 1_000_000
"""of a message by WebSocket"""
_UPLOADS = ("/api/imports",)


def most_bytes(path: str) -> int:
    """Return how many bytes the body of a request for `path` may have."""
    return MOST_UPLOADED if path in _UPLOADS else MOST_OF_A_BODY
