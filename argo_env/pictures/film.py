"""A film of a run, made from its record: a camera follows the robot through the site, several
processes may draw the frames, and an animated GIF or H.264 in an .mp4 takes them one by one."""

import math
import os
import struct
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import IO

import numpy as np
from loky import ProcessPoolExecutor
from loky.process_executor import BrokenProcessPool
from PIL import GifImagePlugin, Image

from argo_compiler.base.errors import Invalid, Unavailable, located
from argo_compiler.base.extras import install_line
from argo_compiler.files.atomic_write import atomic_draft, check_writable
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors
from argo_env.pictures.camera import Camera
from argo_env.pictures.caption import add_caption, add_verdict
from argo_env.pictures.chase import ChaseCamera
from argo_env.pictures.light import compose, depth_shading
from argo_env.pictures.motion import RecordedMotion, check_site
from argo_env.pictures.scene import Scene
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site
from argo_env.worker_processes import end_with_parent, usable_processors

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


_DECKS = 2  # the robot's floor and the one below it are seen from above
_WORTH_IT = 60  # shots: processes take as long to begin as a few of them to be drawn


@dataclass(frozen=True)
class FilmShot:
    """A moment of the run as the camera sees it."""

    t: float
    """s"""
    floor: int
    pose: BodyPose
    joints: Mapping[str, float]
    """deg, by name"""
    camera: Camera
    shown: int
    """how many frames of the film show it"""


def shots_of(
    motion: RecordedMotion,
    scene: Scene,
    times: list[float],
    size: tuple[int, int],
    frame_time: float,
) -> Iterator[FilmShot]:
    """A shot for each of the times (s), one for equal ones that follow each other. The scene tells
    what stands in the camera's way; `frame_time` (s) is how long a frame is shown."""
    camera = ChaseCamera(scene, size, frame_time)
    for t, same in groupby(times):
        pose, floor = motion.pose(t), motion.floor(t)
        scene.show_floors(floor, _DECKS)
        yield FilmShot(t, floor, pose, motion.joints(t), camera.follow(pose), len(list(same)))


def draw(record: RunRecord, scene: Scene, shot: FilmShot, end: float) -> Image.Image:
    """The frame of a shot; at the `end` (s) of the run it says how it went."""
    scene.show_floors(shot.floor, _DECKS)
    scene.place_robot(shot.pose, shot.joints)
    view = scene.look(shot.camera)
    brightness = depth_shading(view, shot.camera.size[1] / 50, 0.45)
    frame = add_caption(Image.fromarray(compose(view, brightness)), record, shot.t, shot.floor)
    return add_verdict(frame, record) if shot.t >= end else frame


def draw_all(
    record: RunRecord, site: Site, robot: RobotSpec, shots: list[FilmShot], end: float
) -> Iterator[Image.Image]:
    """The frames of the shots in their order, drawn by all processors if there are many.

    Raises Unavailable if a process that draws is killed.
    """
    workers = min(usable_processors(), len(shots) // (_WORTH_IT // 2))
    if workers < 2:
        with Scene(site, robot) as scene:
            yield from (draw(record, scene, shot, end) for shot in shots)
        return
    executor = ProcessPoolExecutor(
        workers, initializer=_begin, initargs=(os.getpid(), record, site, robot, end)
    )
    try:
        yield from executor.map(_drawn, shots)
    except BrokenProcessPool:
        raise Unavailable(
            "a process that drew the frames was ended: is there enough memory?"
        ) from None
    finally:
        executor.shutdown(wait=True, kill_workers=True)


_drawing: tuple[RunRecord, Scene, float]
"""of a worker process: what it draws, and where"""


def _begin(parent: int, record: RunRecord, site: Site, robot: RobotSpec, end: float) -> None:
    global _drawing
    end_with_parent(parent)
    _drawing = record, Scene(site, robot), end


def _drawn(shot: FilmShot) -> Image.Image:
    record, scene, end = _drawing
    return draw(record, scene, shot, end)


MP4_SIZE, MP4_FPS = (640, 400), 12
GIF_SIZE, GIF_FPS = (480, 300), 6  # a GIF is many times larger than an .mp4 of the same frames
_PALETTE_SAMPLES = 6
VERDICT_TIME = 2.0
"""s, for which the film stands still in the end and shows the verdict"""

Progress = Callable[[float], None]
"""Told the share that is done, from 0 to 1."""


def check_film(file: Path) -> None:
    """Raises ArgoError if no film can be written there: for its suffix, its folder, or an extra
    that isn't installed. To be called before a long run is made."""
    if file.suffix.lower() not in {".mp4", ".gif"}:
        raise Invalid(f"{file}: a film is an .mp4 or a .gif; name the file so")
    check_writable(file)
    if file.suffix.lower() == ".mp4":
        find_ffmpeg()


def write_film(
    record: RunRecord,
    site: Site,
    robot: RobotSpec,
    file: Path,
    speed: float = 10.0,
    fps: int | None = None,
    size: tuple[int, int] | None = None,
    progress: Progress | None = None,
) -> None:
    """Writes a film of the run, `speed` times as fast as it was and with the verdict in the end,
    as .mp4 or .gif.

    Without `fps` (frames a second) and `size` (px, even), an .mp4 has 12 and 640 by 400, a .gif 6
    and 480 by 300. A GIF shows each frame for a whole number of hundredths of a second. Equal
    records give equal films. Raises ArgoError where `check_film` does, if the record is of another
    site or has no path, if a number makes no sense, or if the film can't be written.
    """
    check_film(file)
    check_site(record, site)
    is_gif = file.suffix.lower() == ".gif"
    fps = fps or (GIF_FPS if is_gif else MP4_FPS)
    width, height = size or (GIF_SIZE if is_gif else MP4_SIZE)
    if not (speed > 0 and math.isfinite(speed) and 0 < fps <= 60):
        raise Invalid(f"a film needs a speed above 0 and 1 to 60 frames a second: {speed}, {fps}")
    if min(width, height) < 64 or width % 2 or height % 2:
        raise Invalid(f"a film needs an even width and height from 64 px: {width}x{height}")
    frame_time = round(100 / fps) / 100 if is_gif else 1 / fps
    motion = RecordedMotion(record, robot)
    count = math.ceil(motion.end / (speed * frame_time) - 1e-9) + 1
    times = [min(k * speed * frame_time, motion.end) for k in range(count)]
    times += [motion.end] * (round(VERDICT_TIME / frame_time) - 1)
    with (
        reporting_write_errors(file, "the film", CHOOSE_ANOTHER_PLACE),
        atomic_draft(file) as draft,
    ):
        with Scene(site, robot) as scene:
            shots = [*shots_of(motion, scene, times, (width, height), frame_time)]
            spread = _spread(times) if is_gif else []
            sampled = shots_of(motion, scene, spread, (width, height), math.inf)
            samples = [draw(record, scene, shot, motion.end) for shot in sampled]
        frames = _shown(draw_all(record, site, robot, shots, motion.end), shots, progress)
        if is_gif:
            write_gif(frames, draft, make_palette(samples), frame_time)
        else:
            try:
                write_mp4(frames, draft, (width, height), fps)
            except Unavailable as error:
                raise located(error, str(file)) from None


def _spread(times: list[float]) -> list[float]:
    """Some of the times (s), as far apart as possible."""
    picks = np.linspace(0, len(times) - 1, _PALETTE_SAMPLES).round().astype(int)
    return [times[k] for k in dict.fromkeys(picks.tolist())]


def _shown(
    drawn: Iterable[Image.Image], shots: list[FilmShot], progress: Progress | None
) -> Iterator[Image.Image]:
    """Each frame as often as the film shows it."""
    count, done = sum(shot.shown for shot in shots), 0
    for frame, shot in zip(drawn, shots, strict=True):
        for _ in range(shot.shown):
            yield frame
            done += 1
            if progress:
                progress(done / count)
