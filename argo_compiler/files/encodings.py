"""Which encoding a text is in, where its bytes leave no doubt."""

import codecs

_MARKS = {
    # The longer first: UTF-32 begins as UTF-16 does.
    codecs.BOM_UTF32_LE: "utf-32-le",
    codecs.BOM_UTF32_BE: "utf-32-be",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
_PLAIN = 0.9  # share of characters from Latin-1 that shows UTF-16 without a mark


def encoding_of(content: bytes) -> str | None:
    """`utf-8`, which other 8-bit encodings are taken for too, `utf-16-le`, `utf-16-be`,
    `utf-32-le` or `utf-32-be`; None for what is no text but binary."""
    for mark, encoding in _MARKS.items():
        if content.startswith(mark):
            return encoding
    return _unmarked_utf16(content) if b"\0" in content else "utf-8"


def _unmarked_utf16(content: bytes) -> str | None:
    """By the zero bytes at every second place, which Latin letters have there and nowhere else."""
    if len(content) % 2:
        return None
    for encoding, low in (("utf-16-le", 0), ("utf-16-be", 1)):
        letters, zeros = content[low::2], content[1 - low :: 2]
        if 0 not in letters and zeros.count(0) >= _PLAIN * len(zeros):
            return encoding
    return None
