"""Command-line options shared by benchmarks and campaigns."""

import argparse


def parse_seed(text: str) -> int:
    """Parse a seed, a whole number of 0 or more; the `type` of an argument of argparse."""
    try:
        number = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"it must be a whole number, not {text}") from None
    if number < 0:
        raise argparse.ArgumentTypeError(f"it must be 0 or more, not {number}")
    return number
