"""Options that several of the commands here have."""

import argparse


def seed_number(text: str) -> int:
    """A seed, as `type` of an argument: a whole number of 0 or more."""
    try:
        number = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"it has to be a whole number, not {text}") from None
    if number < 0:
        raise argparse.ArgumentTypeError(f"it has to be 0 or more, not {number}")
    return number
