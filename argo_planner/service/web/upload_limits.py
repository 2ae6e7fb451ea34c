"""Limits on requests: sizes in bytes, times in s, and the number of those under way."""

MAX_UPLOAD_BYTES = 50_000_000
"""limit of an import, which may be a bag; scripts and mission files have smaller limits"""
MAX_BODY_BYTES = 2_000_000
"""limit of the body of any other request"""
MAX_MESSAGE_BYTES = 1_000_000
"""limit of a message over a WebSocket"""
MOST_REQUESTS = 500
"""requests and pages of one token that may be under way at once, a quarter of all connections"""
PART_TIMEOUT = 20.0
"""time in which the next part of a body must arrive"""
REQUEST_TIMEOUT = 180.0
"""time in which a request must be answered, with its body"""
_UPLOADS = ("/api/imports",)


def max_body_bytes(path: str) -> int:
    """Return the largest size in bytes of the body of a request to the address `path`."""
    return MAX_UPLOAD_BYTES if path in _UPLOADS else MAX_BODY_BYTES
