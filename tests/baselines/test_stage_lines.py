"""What takes long is told in lines now and then, with the time that is left."""

from baselines.stage_lines import StageLines


def test_a_line_every_ten_seconds_with_the_time_left() -> None:
    now = [0.0]
    lines: list[str] = []
    told = StageLines(lines.append, lambda: now[0])
    for second in range(26):
        now[0] = float(second)
        told("practising", second / 40, f"{second} steps")
    told("practising", None, "")
    told(None, None, "")
    now[0] = 100.0
    told("evaluating", 0.0, "")
    now[0] = 110.0
    told("finding the surface", None, "")
    assert lines == [
        "practising: 25%, 10 steps, about 30 s left",
        "practising: 50%, 20 steps, about 20 s left",
        "evaluating: 0%",
        "finding the surface …",
    ]
