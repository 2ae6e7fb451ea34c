"""Limits on the size of uploads, of other request bodies and of messages, in bytes."""

from argo_compiler.files.mission_file import MAX_BYTES

MAX_UPLOAD_BYTES = MAX_BYTES
"""limit of an imported mission, the same as that of a mission file; scripts have a smaller limit of
their own, in `argo_compiler/script/syntax/reading.py`"""
MAX_BODY_BYTES = 2_000_000
"""limit of the body of any other request"""
MAX_MESSAGE_BYTES = 1_000_000
"""limit of a message over a WebSocket"""
_UPLOADS = ("/api/imports",)


def max_body_bytes(path: str) -> int:
    """Return the largest size in bytes of the body of a request to the address `path`."""
    return MAX_UPLOAD_BYTES if path in _UPLOADS else MAX_BODY_BYTES
