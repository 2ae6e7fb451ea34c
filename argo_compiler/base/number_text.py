"""Numbers as text without loss."""


def number_text(value: float) -> str:
    """Return the value as text that is read back as the same value; whole numbers have no point."""
    whole = value == int(value) and abs(value) < 1e15
    return str(int(value)) if whole else repr(float(value))
