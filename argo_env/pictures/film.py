"""A film of a run, made from its record.

A camera follows the robot through the site. Several processes may draw the frames, which are
written one by one to an animated GIF or to H.264 in an .mp4.
"""

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
from loky.process_executor import BrokenProcessPool
from PIL import GifImagePlugin, Image

from argo_compiler.base.errors import Invalid, Unavailable, with_message_prefix
from argo_compiler.base.extras import install_line
from argo_compiler.base.process_pool import ProcessPool
from argo_compiler.base.stages import stage
from argo_compiler.files.atomic_write import atomic_draft, check_writable
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors
from argo_env.pictures.camera import Camera
from argo_env.pictures.caption import with_caption, with_verdict
from argo_env.pictures.chase import ChaseCamera
from argo_env.pictures.light import depth_shading, shade_view
from argo_env.pictures.motion import RecordedMotion, check_record_site
from argo_env.pictures.scene import Scene
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site
from argo_env.worker_processes import ignore_sigint_and_end_with_parent, usable_processors
from argo_env.world.pybullet_client import require_pybullet

GIF_COLOURS = 128


def find_ffmpeg() -> str:
    """Return the path of the ffmpeg program.

    Raises:
        Unavailable: The extra isn't installed, or contains no ffmpeg for this computer.
    """
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
    """Write RGB frames of even width and height as H.264 that browsers can play.

    Raises:
        Unavailable: ffmpeg fails or isn't installed.
        OSError: The file can't be written.
    """
    with tempfile.TemporaryFile() as messages:
        encoder = subprocess.Popen(
            [
                *(find_ffmpeg(), "-y", "-loglevel", "error"),
                *("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}"),
                *("-r", str(fps), "-i", "-", "-an", "-c:v", "libx264", "-preset", "veryfast"),
                # Always two threads, so that equal frames give equal files on all machines.
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
            # The encoder closes the pipe when it fails, and prints the error.
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
            error = messages.read().decode(errors="replace").strip() or f"status {status}"
            error = error.replace(f"{file.absolute()}: ", "")  # users don't know the draft's name
            raise Unavailable(f"ffmpeg can't write the film: {error}")


def write_gif(
    frames: Iterable[Image.Image], file: Path, palette: Image.Image, frame_time: float
) -> None:
    """Write RGB frames as a GIF that loops, in the colours of `palette`, a palette image.

    `frame_time` (s) has to be a whole number of hundredths, which is not checked.

    Raises:
        OSError: The file can't be written.
    """
    with file.open("wb") as stream:
        size: tuple[int, int] | None = None
        for frame in frames:
            if size is None:
                size = frame.size
                _write_gif_header(stream, size, palette)
            indexed = frame.quantize(palette=palette, dither=Image.Dither.NONE)
            # Pillow's own writer of several frames keeps all of them in memory.
            blocks = GifImagePlugin.getdata(indexed, duration=round(frame_time * 1000), interlace=0)
            for block in blocks:
                stream.write(block)
        stream.write(b";")


def make_palette(samples: list[Image.Image]) -> Image.Image:
    """Return a palette image with GIF_COLOURS colours that represent those of the samples.

    The samples are RGB images of one size. Median cut chooses the colours.
    """
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)))
    for row, sample in enumerate(samples):
        sheet.paste(sample, (0, row * height))
    return sheet.quantize(GIF_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def _write_gif_header(stream: IO[bytes], size: tuple[int, int], palette: Image.Image) -> None:
    """Write what precedes the first frame: the size, the colours of all frames, and the loop."""
    colours = bytes(palette.getpalette() or []).ljust(768, b"\0")[:768]
    stream.write(b"GIF89a" + struct.pack("<HHBBB", *size, 0b1111_0111, 0, 0) + colours)
    stream.write(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00")


_DECKS = 2  # the robot's floor and the one below it are visible from above
_MIN_PARALLEL_SHOTS = 60  # fewer are drawn before processes have started


@dataclass(frozen=True)
class FilmShot:
    """A moment of the run in the camera's view."""

    t: float
    """time in s"""
    floor: int
    pose: BodyPose
    joints: Mapping[str, float]
    """positions in deg, by name"""
    camera: Camera
    repeats: int
    """number of frames of the film that show it"""


def plan_shots(
    motion: RecordedMotion,
    scene: Scene,
    times: list[float],
    size: tuple[int, int],
    frame_time: float,
) -> Iterator[FilmShot]:
    """Yield a shot for each of the times, and only one for consecutive equal times.

    Args:
        motion: Motion of the robot.
        scene: Scene that shows what may hide the robot from the camera.
        times: Times in s.
        size: Width and height of the frames in px.
        frame_time: Duration (s) for which a frame is shown.
    """
    camera = ChaseCamera(scene, size, frame_time)
    for t, same in groupby(times):
        pose, floor = motion.pose_at(t), motion.floor_at(t)
        scene.show_floors(floor, _DECKS)
        yield FilmShot(
            t, floor, pose, motion.joint_degrees_at(t), camera.next_camera(pose), len(list(same))
        )


def draw_frame(record: RunRecord, scene: Scene, shot: FilmShot, end: float) -> Image.Image:
    """Return the drawn frame of a shot; from the `end` (s) of the run on it shows the verdict."""
    scene.show_floors(shot.floor, _DECKS)
    scene.place_robot(shot.pose, shot.joints)
    view = scene.render_from(shot.camera)
    brightness = depth_shading(view, shot.camera.size[1] / 50, 0.45)
    frame = with_caption(Image.fromarray(shade_view(view, brightness)), record, shot.t, shot.floor)
    return with_verdict(frame, record) if shot.t >= end else frame


def draw_frames(
    record: RunRecord, site: Site, robot: RobotSpec, shots: list[FilmShot], end: float
) -> Iterator[Image.Image]:
    """Yield the frames of the shots in their order; several processes draw many shots.

    Raises:
        Unavailable: A process that draws is killed.
    """
    workers = min(usable_processors(), len(shots) // (_MIN_PARALLEL_SHOTS // 2))
    if workers < 2:
        with Scene(site, robot) as scene:
            yield from (draw_frame(record, scene, shot, end) for shot in shots)
        return
    executor = ProcessPool(
        workers, initializer=_start_worker, initargs=(os.getpid(), record, site, robot, end)
    )
    try:
        yield from executor.map(_draw_shot, shots)
    except BrokenProcessPool:
        raise Unavailable(
            "a process that drew the frames was killed, perhaps for lack of memory; "
            "free some memory, and try again"
        ) from None
    finally:
        executor.shutdown(wait=True, kill_workers=True)


_drawing: tuple[RunRecord, Scene, float]
"""record and scene of a worker process, and the end of the run in s"""


def _start_worker(parent: int, record: RunRecord, site: Site, robot: RobotSpec, end: float) -> None:
    global _drawing
    ignore_sigint_and_end_with_parent(parent)
    _drawing = record, Scene(site, robot), end


def _draw_shot(shot: FilmShot) -> Image.Image:
    record, scene, end = _drawing
    return draw_frame(record, scene, shot, end)


MP4_SIZE, MP4_FPS = (640, 400), 12
GIF_SIZE, GIF_FPS = (480, 300), 6  # a GIF is many times larger than an .mp4 of the same frames
_PALETTE_SAMPLES = 6
VERDICT_TIME = 2.0
"""s for which the film stops at its end and shows the verdict"""


def check_film(file: Path) -> None:
    """Raise an error if no film can be written to the file.

    Call this before a long run.

    Raises:
        ArgoError: The suffix or the folder is wrong, or something that it needs isn't installed.
    """
    if file.suffix.lower() not in {".mp4", ".gif"}:
        raise Invalid(f"{file}: a film is an .mp4 or a .gif; name the file so")
    require_pybullet()
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
    raise_if_interrupted: Callable[[], None] = lambda: None,
) -> None:
    """Write a film of the run as .mp4 or .gif, with the verdict at the end.

    Equal records give equal films. A GIF shows each frame for a whole number of hundredths of a
    second.

    Args:
        record: Record of the run.
        site: Site of the run.
        robot: Robot of the run.
        file: File to write.
        speed: Factor by which the film is faster than the run.
        fps: Frames per second; by default 12 for an .mp4, and 6 for a .gif.
        size: Width and height in px, both even; by default 640 by 400 for an .mp4, and 480 by 300
            for a .gif.
        raise_if_interrupted: Function that is called for each frame, and raises an error to end
            the film.

    Raises:
        ArgoError: The film can't be written (see `check_film`), the record is of another site or
            has no path, or a number is invalid.
    """
    check_film(file)
    check_record_site(record, site)
    is_gif = file.suffix.lower() == ".gif"
    fps = fps or (GIF_FPS if is_gif else MP4_FPS)
    width, height = size or (GIF_SIZE if is_gif else MP4_SIZE)
    if not (speed > 0 and math.isfinite(speed) and 0 < fps <= 60):
        raise Invalid(f"a film needs a speed above 0 and 1 to 60 frames a second: {speed}, {fps}")
    if min(width, height) < 64 or width % 2 or height % 2:
        raise Invalid(f"a film needs an even width and height from 64 px: {width}x{height}")
    frame_time = round(100 / fps) / 100 if is_gif else 1 / fps
    motion = RecordedMotion(record, robot)
    count = math.ceil(motion.end_time / (speed * frame_time) - 1e-9) + 1
    times = [min(k * speed * frame_time, motion.end_time) for k in range(count)]
    times += [motion.end_time] * (round(VERDICT_TIME / frame_time) - 1)
    with (
        reporting_write_errors(file, "the film", CHOOSE_ANOTHER_PLACE),
        atomic_draft(file) as draft,
    ):
        with Scene(site, robot) as scene:
            shots = []
            with stage("placing the film's camera") as report:
                for shot in plan_shots(motion, scene, times, (width, height), frame_time):
                    shots.append(shot)
                    report(shot.t / motion.end_time if motion.end_time else None)
                    raise_if_interrupted()
            spread = _spread_times(times) if is_gif else []
            sampled = plan_shots(motion, scene, spread, (width, height), math.inf)
            samples = [draw_frame(record, scene, shot, motion.end_time) for shot in sampled]
        frames = _repeat_frames(
            draw_frames(record, site, robot, shots, motion.end_time), shots, raise_if_interrupted
        )
        if is_gif:
            write_gif(frames, draft, make_palette(samples), frame_time)
        else:
            try:
                write_mp4(frames, draft, (width, height), fps)
            except Unavailable as error:
                raise with_message_prefix(error, str(file)) from None


def _spread_times(times: list[float]) -> list[float]:
    """Return _PALETTE_SAMPLES of the times (s), evenly by index, or all if there are fewer."""
    picks = np.linspace(0, len(times) - 1, _PALETTE_SAMPLES).round().astype(int)
    return [times[k] for k in dict.fromkeys(picks.tolist())]


def _repeat_frames(
    drawn: Iterable[Image.Image], shots: list[FilmShot], raise_if_interrupted: Callable[[], None]
) -> Iterator[Image.Image]:
    """Yield each frame as often as the film shows it."""
    count, done = sum(shot.repeats for shot in shots), 0
    with stage("drawing the film") as report:
        for frame, shot in zip(drawn, shots, strict=True):
            for _ in range(shot.repeats):
                yield frame
                done += 1
                report(done / count)
                raise_if_interrupted()
