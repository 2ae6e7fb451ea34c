"""Detection of a text's encoding from its bytes."""

import codecs

_MARKS = {
    # The longer mark first: that of UTF-32 begins like that of UTF-16.
    codecs.BOM_UTF32_LE: "utf-32-le",
    codecs.BOM_UTF32_BE: "utf-32-be",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
_MIN_LATIN_SHARE = 0.9  # share of Latin-1 characters that shows UTF-16 without a mark


def detect_encoding(content: bytes) -> str | None:
    """Return the encoding of a text, or None if the content is binary.

    The encoding is `utf-8` (also for other 8-bit encodings), `utf-16-le`, `utf-16-be`, `utf-32-le`
    or `utf-32-be`.
    """
    for mark, encoding in _MARKS.items():
        if content.startswith(mark):
            return encoding
    return _unmarked_utf16(content) if b"\0" in content else "utf-8"


def _unmarked_utf16(content: bytes) -> str | None:
    """Return the kind of UTF-16 of a text without a mark, or None if it is not UTF-16.

    It is found by the zero bytes: in UTF-16, nearly every second byte of Latin text is zero, and no
    other byte.
    """
    if len(content) % 2:
        return None
    for encoding, low in (("utf-16-le", 0), ("utf-16-be", 1)):
        letters, zeros = content[low::2], content[1 - low :: 2]
        if 0 not in letters and zeros.count(0) >= _MIN_LATIN_SHARE * len(zeros):
            return encoding
    return None
