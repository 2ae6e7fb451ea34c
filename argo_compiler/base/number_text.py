"""Numbers as text that loses nothing."""


def number(value: float) -> str:
    """The value as text that is read back as the same value, without a point where it is whole."""
    whole = value == int(value) and abs(value) < 1e15
    return str(int(value)) if whole else repr(float(value))
