"""Films as files, frame by frame: animated GIF, and H.264 in an .mp4."""

import struct
import subprocess
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import IO

from PIL import GifImagePlugin, Image

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line

GIF_COLOURS = 128


def find_ffmpeg() -> str:
    """The path of the ffmpeg program; ArgoError if the extra that brings it isn't installed."""
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise Unavailable(
            f"writing .mp4 needs imageio-ffmpeg: {install_line('film')}, or name a .gif"
        ) from error
    try:
        program: str = imageio_ffmpeg.get_ffmpeg_exe()
    except RuntimeError as error:
        raise Unavailable(
            "imageio-ffmpeg brings no ffmpeg for this computer: "
            "install ffmpeg, set IMAGEIO_FFMPEG_EXE to it, or name a .gif"
        ) from error
    return program


def write_mp4(frames: Iterable[Image.Image], file: Path, size: tuple[int, int], fps: int) -> None:
    """Writes RGB frames of even width and height as H.264 that browsers play.

    Raises ArgoError if ffmpeg fails, and OSError if the file can't be written.
    """
    with tempfile.TemporaryFile() as messages:
        encoder = subprocess.Popen(
            [
                *(find_ffmpeg(), "-y", "-loglevel", "error"),
                *("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}"),
                *("-r", str(fps), "-i", "-", "-an", "-c:v", "libx264", "-preset", "veryfast"),
                # Two threads whatever the machine, so that equal frames give equal files.
                *("-threads", "2", "-crf", "21", "-pix_fmt", "yuv420p"),
                *("-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"),
                *("-movflags", "+faststart", "-f", "mp4", str(file.absolute())),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=messages,
        )
        assert encoder.stdin is not None
        try:
            # The encoder closes its end when it fails; what it says then is the error.
            with suppress(BrokenPipeError):
                for frame in frames:
                    encoder.stdin.write(frame.tobytes())
            with suppress(BrokenPipeError):
                encoder.stdin.close()
            status = encoder.wait()
        except BaseException:
            encoder.kill()
            with suppress(OSError):
                encoder.stdin.close()
            encoder.wait()
            raise
        if status:
            messages.seek(0)
            said = messages.read().decode(errors="replace").strip() or f"status {status}"
            said = said.replace(f"{file.absolute()}: ", "")  # a draft, which nobody knows
            raise Unavailable(f"ffmpeg can't write the film: {said}")


def write_gif(
    frames: Iterable[Image.Image], file: Path, palette: Image.Image, frame_time: float
) -> None:
    """Writes RGB frames as a GIF that loops, all in the colours of `palette`, a palette image.

    `frame_time` (s) is a whole number of hundredths. Raises OSError if the file can't be written.
    """
    with file.open("wb") as stream:
        size: tuple[int, int] | None = None
        for frame in frames:
            if size is None:
                size = frame.size
                _write_gif_header(stream, size, palette)
            indexed = frame.quantize(palette=palette, dither=Image.Dither.NONE)
            # Pillow's own writer of several frames keeps them all until the last has come.
            blocks = GifImagePlugin.getdata(indexed, duration=round(frame_time * 1000), interlace=0)
            for block in blocks:
                stream.write(block)
        stream.write(b";")


def make_palette(samples: list[Image.Image]) -> Image.Image:
    """A palette image with the colours that suit all the samples, RGB of one size, best."""
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)))
    for row, sample in enumerate(samples):
        sheet.paste(sample, (0, row * height))
    return sheet.quantize(GIF_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def _write_gif_header(stream: IO[bytes], size: tuple[int, int], palette: Image.Image) -> None:
    """Everything before the first frame: the size, the colours of all frames, and the loop."""
    colours = bytes(palette.getpalette() or []).ljust(768, b"\0")[:768]
    stream.write(b"GIF89a" + struct.pack("<HHBBB", *size, 0b1111_0111, 0, 0) + colours)
    stream.write(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00")
