"""The frames of a film: what each of them shows, and who draws them."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby

from loky import ProcessPoolExecutor
from loky.process_executor import BrokenProcessPool
from PIL import Image

from argo_compiler.base.errors import Unavailable
from argo_env.pictures.camera import Camera
from argo_env.pictures.caption import add_caption, add_verdict
from argo_env.pictures.chase import ChaseCamera
from argo_env.pictures.light import compose, depth_shading
from argo_env.pictures.motion import RecordedMotion
from argo_env.pictures.scene import Scene
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site
from argo_env.worker_processes import serve_parent, usable_processors

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
    serve_parent(parent)
    _drawing = record, Scene(site, robot), end


def _drawn(shot: FilmShot) -> Image.Image:
    record, scene, end = _drawing
    return draw(record, scene, shot, end)
