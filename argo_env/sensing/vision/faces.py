"""Drawn faces of the checkpoints: textures, and the flat meshes that carry them.

`python -m argo_env.sensing.vision.faces` draws them anew into `urdf/checkpoints/`. A face lies in
the plane of its instrument; seen from the front, z is up in its picture and y to the right.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from argo_compiler.base.catalog import CheckpointKind
from argo_env.files import resources

PIXELS_PER_METRE = 3600
_OVERSAMPLING = 2
_WHITE = (247, 247, 242)
_BLACK = (24, 26, 28)
_GREY = (208, 216, 220)


@dataclass(frozen=True)
class FaceShape:
    """Shape of a face: a disc or a rectangle about its middle."""

    half_width: float
    """m, the radius of a disc"""
    half_height: float
    """m, the radius of a disc"""
    round: bool
    depth: float
    """m from the plane x = 0 of the instrument back to the face"""


FACES: dict[CheckpointKind, FaceShape] = {
    CheckpointKind.PRESSURE_GAUGE: FaceShape(0.068, 0.068, True, 0.002),
    CheckpointKind.LIQUID_LEVEL_GAUGE: FaceShape(0.045, 0.160, False, 0.004),
    CheckpointKind.VALVE: FaceShape(0.085, 0.085, True, 0.012),
}


class _Sheet:
    """Picture to draw on, in metres from its middle, with y to the right and z up."""

    def __init__(self, shape: FaceShape) -> None:
        self._scale = PIXELS_PER_METRE * _OVERSAMPLING
        self._half = (shape.half_width, shape.half_height)
        self._size = tuple(round(2 * h * self._scale) for h in self._half)
        self.image = Image.new("RGB", (self._size[0], self._size[1]), _WHITE)
        self._draw = ImageDraw.Draw(self.image)

    def spot(self, y: float, z: float) -> tuple[float, float]:
        return (self._half[0] + y) * self._scale, (self._half[1] - z) * self._scale

    def polar(self, radius: float, degrees: float) -> tuple[float, float]:
        """Return y and z (m) of a point; its angle (deg) is clockwise from the top."""
        angle = math.radians(degrees)
        return radius * math.sin(angle), radius * math.cos(angle)

    def line(self, a: tuple[float, float], b: tuple[float, float], width: float) -> None:
        self._draw.line([self.spot(*a), self.spot(*b)], _BLACK, round(width * self._scale))

    def box(self, y0: float, z0: float, y1: float, z1: float, colour: tuple[int, int, int]) -> None:
        self._draw.rectangle([self.spot(y0, z1), self.spot(y1, z0)], colour)

    def ring(self, inner: float, outer: float, first: float, last: float) -> None:
        """Draw a part of a ring between radii (m) and clockwise angles from the top (deg)."""
        steps = max(2, round(abs(last - first)))
        angles = [first + (last - first) * k / steps for k in range(steps + 1)]
        corners = [self.polar(outer, a) for a in angles]
        corners += [self.polar(inner, a) for a in reversed(angles)]
        self._draw.polygon([self.spot(*c) for c in corners], _BLACK)

    def text(self, y: float, z: float, words: str, height: float) -> None:
        font = ImageFont.load_default(size=height * self._scale * 1.35)
        self._draw.text(self.spot(y, z), words, _BLACK, font, anchor="mm", stroke_width=3)

    def finished(self) -> Image.Image:
        size = tuple(s // _OVERSAMPLING for s in self._size)
        return self.image.resize((size[0], size[1]), Image.Resampling.BOX)


def _dial(sheet: _Sheet) -> None:
    """Draw a dial of 0 to 10 bar over 270 degrees."""
    sheet.ring(0.0650, 0.0690, 0, 360)
    sheet.ring(0.0575, 0.0615, -135, 135)
    for k in range(51):
        long = k % 5 == 0
        angle = -135 + 270 * k / 50
        inner = 0.047 if long else 0.053
        width = 0.0024 if long else 0.0010
        sheet.line(sheet.polar(inner, angle), sheet.polar(0.058, angle), width)
    for value in range(0, 11, 2):
        sheet.text(*sheet.polar(0.0365, -135 + 27 * value), str(value), 0.0095)
    sheet.box(-0.016, -0.059, 0.016, -0.044, _BLACK)
    sheet.box(-0.0135, -0.0565, 0.0135, -0.0465, _WHITE)
    sheet.text(0.0, -0.0520, "bar", 0.008)


def _level(sheet: _Sheet) -> None:
    """Draw a scale of 0 to 100 % over 240 mm, beside a glass that is 34 mm wide."""
    shape = FACES[CheckpointKind.LIQUID_LEVEL_GAUGE]
    sheet.box(-shape.half_width, -shape.half_height, shape.half_width, shape.half_height, _BLACK)
    edge = 0.006
    sheet.box(
        edge - shape.half_width, edge - shape.half_height,
        shape.half_width - edge, shape.half_height - edge, _WHITE,
    )  # fmt: skip
    sheet.box(-0.019, -0.135, 0.019, 0.135, _BLACK)
    sheet.box(-0.017, -0.133, 0.017, 0.133, _GREY)
    for k in range(21):
        z = -0.12 + 0.24 * k / 20
        long = k % 2 == 0
        reach = 0.026 if long else 0.023
        for side in (-1, 1):
            sheet.line((side * 0.018, z), (side * reach, z), 0.0022 if long else 0.0012)
        if k % 4 == 0:
            sheet.text(0.0322, z, str(5 * k), 0.0054)
    sheet.text(0.0, 0.1445, "%", 0.010)
    sheet.box(-0.030, -0.150, 0.030, -0.140, _BLACK)


def _valve(sheet: _Sheet) -> None:
    """Draw the plate of a valve: shut with the lever up, open with the lever to the right."""
    sheet.ring(0.0800, 0.0860, 0, 360)
    sheet.ring(0.068, 0.076, 0, 90)
    for k in range(7):
        sheet.line(sheet.polar(0.059, 15 * k), sheet.polar(0.070, 15 * k), 0.0024)
    sheet.text(*sheet.polar(0.064, -18), "S", 0.016)
    sheet.text(*sheet.polar(0.064, 108), "O", 0.016)
    sheet.ring(0.036, 0.073, 187, 263)


_DRAWINGS: dict[CheckpointKind, Callable[[_Sheet], None]] = {
    CheckpointKind.PRESSURE_GAUGE: _dial,
    CheckpointKind.LIQUID_LEVEL_GAUGE: _level,
    CheckpointKind.VALVE: _valve,
}


def draw_face(kind: CheckpointKind) -> Image.Image:
    """Return the drawn face of an instrument, seen from the front, with `PIXELS_PER_METRE`."""
    sheet = _Sheet(FACES[kind])
    _DRAWINGS[kind](sheet)
    return sheet.finished()


def face_file(kind: CheckpointKind) -> Path:
    """Return the path of the PNG with the drawn face of this kind of instrument."""
    return resources.urdf_folder() / "checkpoints" / f"{kind.value.replace(' ', '_')}_face.png"


def face_mesh_text(kind: CheckpointKind) -> str:
    """Return the flat mesh that shows an instrument's drawn face, as text in Wavefront OBJ.

    The mesh lies in the plane x = 0 about the face's middle, in m; its normal is along +x.
    """
    shape = FACES[kind]
    if shape.round:
        angles = [2 * math.pi * k / 64 for k in range(64)]
        outline = [(math.cos(a), math.sin(a)) for a in angles]
    else:
        outline = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    stem = face_file(kind).stem
    lines = [f"mtllib {stem}.mtl", "o face"]
    lines += [f"v 0 {y * shape.half_width:.6f} {z * shape.half_height:.6f}" for y, z in outline]
    lines += [f"vt {(1 + y) / 2:.6f} {(1 + z) / 2:.6f}" for y, z in outline]
    lines += ["vn 1 0 0", "usemtl face"]
    lines += [
        f"f 1/1/1 {k}/{k}/1 {k + 1}/{k + 1}/1" for k in range(2, len(outline))
    ]  # a fan about the first corner
    return "\n".join(lines) + "\n"


def write_faces() -> None:
    """Draw the faces of all kinds, and write them with their meshes to `urdf/checkpoints/`."""
    for kind in CheckpointKind:
        path = face_file(kind)
        draw_face(kind).quantize(32).save(path, optimize=True)
        path.with_suffix(".obj").write_text(face_mesh_text(kind), encoding="utf-8")
        material = f"newmtl face\nKa 1 1 1\nKd 1 1 1\nmap_Kd {path.name}\n"
        path.with_suffix(".mtl").write_text(material, encoding="utf-8")


if __name__ == "__main__":
    write_faces()
