"""Times, positions and numbers as texts for terminals, reports and films."""

from collections.abc import Callable

from argo_env.site.shapes import Vector


def min_sec_text(seconds: float, to_whole: Callable[[float], int] = round) -> str:
    """Return a time in s as text in minutes and seconds, such as `04:59` or `74:51` (no hours).

    `to_whole` rounds it to whole seconds: `rounded_down` for a lower bound, `rounded_up` for an
    upper one (`argo_compiler.base.quantity_text`).
    """
    whole = to_whole(seconds)
    return f"{whole // 60:02d}:{whole % 60:02d}"


def rounded_time_text(seconds: float, to_whole: Callable[[float], int] = round) -> str:
    """Return a time in s with its unit, such as `34 s`, `4:59 min` or `1:14:51 h`.

    `to_whole` rounds it to whole seconds, as for `min_sec_text`.
    """
    minutes, rest = divmod(to_whole(seconds), 60)
    if minutes == 0:
        return f"{rest} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d} h" if hours else f"{minutes}:{rest:02d} min"


def floor_and_position_text(floor: int | None, place: Vector) -> str:
    """Return a position in m on a floor as text, such as `floor 2 at (1.00, 2.00, 2.50)`.

    If the floor is not known (None), it is the position alone, such as `(1.00, 2.00, 2.50)`.
    """
    x, y, z = place
    position = f"({x:.2f}, {y:.2f}, {z:.2f})"
    return position if floor is None else f"floor {floor} at {position}"


def distinct_texts(first: float, second: float) -> tuple[str, str]:
    """Return two numbers as texts, both with the fewest decimals (0 to 5) that make them differ.

    Equal numbers get no decimals.
    """
    for digits in range(6):
        texts = f"{first:.{digits}f}", f"{second:.{digits}f}"
        if texts[0] != texts[1] or first == second:
            break
    return texts


def distinct_time_texts(first: float, second: float) -> tuple[str, str]:
    """Return two times in s as texts with units, which differ unless the times are equal.

    Times that have the same text in whole seconds are written in seconds with decimals.
    """
    texts = rounded_time_text(first), rounded_time_text(second)
    if texts[0] != texts[1] or first == second:
        return texts
    one, other = distinct_texts(first, second)
    return f"{one} s", f"{other} s"
