"""Captions of frames, with the time, the task, the floor, the last reading and the verdict."""

import math
from collections.abc import Sequence

from PIL import Image, ImageDraw, ImageFont

from argo_env.formatting import min_sec_text
from argo_env.run.record import Reading, RunRecord
from argo_env.run.verdict_line import Tone

HEIGHT = 0.105  # of the bar, as a share of the frame's
LINES = 3  # of the verdict, at most
Text = tuple[str, tuple[int, int, int, int]]
"""text and its colour"""
_Font = ImageFont.FreeTypeFont
_BAR = (20, 28, 38, 205)
BRIGHT, DIM = (255, 255, 255, 255), (178, 190, 204, 255)
_NORMAL, _ABNORMAL = (110, 226, 160, 255), (255, 128, 120, 255)
_TONES = {Tone.GOOD: _NORMAL, Tone.NOTICE: (255, 196, 92, 255), Tone.BAD: _ABNORMAL}


def with_caption(frame: Image.Image, record: RunRecord, t: float, floor: int) -> Image.Image:
    """Return a copy of the RGB frame with a bar at its bottom that describes the run at `t` (s).

    `floor` is the number of the floor that the robot is on.
    """
    return with_bar_over_bottom(frame, *_caption_texts(record, t, floor))


def with_bar_over_bottom(
    frame: Image.Image, left: Sequence[Text], right: Sequence[Text]
) -> Image.Image:
    """Return a copy of the RGB frame with a bar at its bottom that has texts at both ends."""
    width, height = frame.size
    bar = Image.new("RGBA", (width, round(height * HEIGHT)), _BAR)
    draw = ImageDraw.Draw(bar)
    size = bar.height * 0.40
    while True:
        font = ImageFont.load_default(size)
        gap = size * 0.8
        total = sum(draw.textlength(text, font=font) + gap for text, _ in (*left, *right))
        if total + gap <= width or size <= 7:
            break
        size *= 0.94
    x = gap
    for text, ink in left:
        draw.text((x, bar.height / 2), text, fill=ink, font=font, anchor="lm")
        x += draw.textlength(text, font=font) + gap
    x = width - gap
    for text, ink in reversed(right):
        draw.text((x, bar.height / 2), text, fill=ink, font=font, anchor="rm")
        x -= draw.textlength(text, font=font) + gap
    result = frame.copy()
    result.paste(bar, (0, height - bar.height), bar)
    return result


def with_verdict(frame: Image.Image, record: RunRecord) -> Image.Image:
    """Return a copy of the RGB frame with the verdict of the run in a bar above the caption.

    The area of the caption stays free, whether the frame has one already or not.
    """
    width, height = frame.size
    headline = record.headline
    word, ink = headline.word, _TONES[headline.tone]
    size = height * HEIGHT * 0.40
    font = ImageFont.load_default(size)
    gap, pitch = size * 0.8, size * 1.35
    draw = ImageDraw.Draw(frame)
    indent = draw.textlength(f"{word}:  ", font=font)
    lines = _wrap_lines(headline.text, draw, font, width - 2 * gap - indent)
    bar = Image.new("RGBA", (width, round(pitch * len(lines) + 2 * gap - (pitch - size))), _BAR)
    draw = ImageDraw.Draw(bar)
    draw.text((gap, gap + size / 2), f"{word}:", fill=ink, font=font, anchor="lm")
    for k, line in enumerate(lines):
        position = (gap + indent, gap + size / 2 + k * pitch)
        draw.text(position, line, fill=BRIGHT, font=font, anchor="lm")
    result = frame.copy()
    result.paste(bar, (0, height - round(height * HEIGHT) - bar.height), bar)
    return result


def _wrap_lines(
    text: str, draw: ImageDraw.ImageDraw, font: ImageFont.ImageFont | _Font, room: float
) -> list[str]:
    """Return at most LINES lines of at most `room` px; `…` stands for what does not fit."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if draw.textlength(longer, font=font) <= room or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)
    if len(lines) > LINES:
        lines = [*lines[: LINES - 1], f"{lines[LINES - 1]} …"]
    for k, line in enumerate(lines):
        shown = line
        while draw.textlength(shown, font=font) > room and len(shown) > 2:
            shown = f"{shown[:-2].rstrip()}…"
        lines[k] = shown
    return lines


def _caption_texts(record: RunRecord, t: float, floor: int) -> tuple[list[Text], list[Text]]:
    """Return the texts at the left and the right of the bar."""
    under_way = [run.task for run in record.tasks if run.start <= t < run.end]
    task = under_way[-1] if under_way else ("ended" if t > 0 else "setting off")
    left = [(min_sec_text(math.floor(t)), BRIGHT), (task, BRIGHT), (f"floor {floor}", DIM)]
    taken = [reading for reading in record.readings if reading.t <= t]
    return left, (_reading_texts(taken[-1]) if taken else [])


def _reading_texts(reading: Reading) -> list[Text]:
    value = f"{reading.name}: {reading.value:g} {reading.unit}"
    if reading.normal:
        return [(value, BRIGHT), ("nominal", _NORMAL)]
    return [(value, BRIGHT), ("not nominal", _ABNORMAL)]
