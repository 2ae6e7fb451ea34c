"""Progress of long computations is printed in lines, with the remaining time."""

from baselines.stage_lines import StageLines


def test_a_line_every_ten_seconds_with_the_remaining_time() -> None:
    now = [0.0]
    lines: list[str] = []
    listener = StageLines(lines.append, lambda: now[0])
    for second in range(26):
        now[0] = float(second)
        listener("practising", second / 40, f"{second} steps")
    listener("practising", None, "")
    listener(None, None, "")
    now[0] = 100.0
    listener("evaluating", 0.0, "")
    now[0] = 110.0
    listener("finding the surface", None, "")
    assert lines == [
        "practising: 25%, 10 steps, about 30 s left",
        "practising: 50%, 20 steps, about 20 s left",
        "evaluating: 0%",
        "finding the surface …",
    ]
