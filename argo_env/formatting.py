"""Times and places in words, as people read them on the terminal, in reports and in films."""

from argo_env.site.shapes import Vector


def clock(seconds: float) -> str:
    """Minutes and seconds, such as 04:59."""
    whole = round(seconds)
    return f"{whole // 60:02d}:{whole % 60:02d}"


def where(floor: int | None, place: Vector) -> str:
    """A place (m) on a floor, such as `floor 2 at (1.00, 2.00, 2.50)`."""
    x, y, z = place
    return f"floor {floor} at ({x:.2f}, {y:.2f}, {z:.2f})"


def told_apart(first: float, second: float) -> tuple[str, str]:
    """Two numbers in whole units, or with as many decimals as it takes to see that they differ."""
    for digits in range(6):
        told = f"{first:.{digits}f}", f"{second:.{digits}f}"
        if told[0] != told[1] or first == second:
            break
    return told
