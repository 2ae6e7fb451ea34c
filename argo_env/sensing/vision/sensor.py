"""The camera sensor: reads checkpoints from pictures that it takes with the camera on the arm."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError
from argo_env.sensing.vision.align import FacePose, Fit
from argo_env.sensing.vision.arm import JOINTS
from argo_env.sensing.vision.indicator import (
    PictureReading,
    combine_readings,
    find_indicator,
    probability,
)
from argo_env.sensing.vision.instrument import DIAL, LEVEL, VALVE, Instrument
from argo_env.sensing.vision.locate import find_face, look_closer
from argo_env.sensing.vision.photo import Lens, Photo, make_photo, take_picture
from argo_env.sensing.vision.views import ArmView, plan_views, solids_near
from argo_env.site import SiteCheckpoint
from argo_env.site.shapes import Solid
from argo_env.world.placement import MAX_OFFSET
from argo_env.world.world import Shot, World

INSTRUMENTS = {instrument.kind: instrument for instrument in (DIAL, VALVE, LEVEL)}

MIN_CONFIDENCE = 0.5
"""Readings that are less sure are not told."""

_SEARCH_PIXELS, _PIXELS = 400, 320  # width and height of a picture
_TURNS = np.radians([0, 55, -55, 80, -80, 20, -20])  # that a checkpoint is looked for at
_LOOKS = 4  # closer looks at one that was found
_SPREAD = math.radians(25)  # between two looks, if possible
_SAME = math.radians(8)  # between two looks that show the same
_ENOUGH = 0.98  # confidence from which no further look is taken
_FOUND = 0.72  # match from which a face counts as found
_SEEN = 0.6  # match from which a closer look tells something
_SURELY = 0.92  # match from which a closer look needs no second search
_CLEARLY = 0.86  # match from which no further search is made
_DARK = 0.07  # of full scale: pictures whose bright parts are darker are too dark
_STEEP = math.radians(62)


class CameraSensor:
    """Reads checkpoints by camera. Holds the world that it takes pictures of."""

    name = "camera"

    def __init__(self, world: World, seed: int = 0) -> None:
        """Raises ArgoError if OpenCV is not installed, or the robot's arm can't be aimed."""
        try:
            import cv2  # noqa: F401
        except ImportError as error:
            raise Unavailable(
                f"the sensor `camera` needs OpenCV: {install_line('vision')}"
            ) from error
        if missing := [joint for joint in JOINTS if joint not in world.robot.arm_raised]:
            raise Invalid(
                f"the sensor `camera` aims an arm with the joints {', '.join(JOINTS)}; robot "
                f"{world.robot.name} has no {', '.join(missing)}: take the sensor `ideal`"
            )
        self._world = world
        self._seed = seed
        self._solids: dict[int, tuple[Solid, ...]] = {}

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Looks at the checkpoint from as many views as it takes.

        Raises MeasurementError, with a reason, where no reading is sure enough.
        """
        checkpoint = self._world.site.checkpoint(checkpoint_id)
        before = dict(zip(JOINTS, self._world.joint_positions(JOINTS), strict=True))
        try:
            return self._measure(checkpoint, pose)
        finally:
            self._world.set_joints(before)

    def _measure(self, checkpoint: SiteCheckpoint, pose: BodyPose) -> Measurement:
        x, y, z = checkpoint.position
        planned = FacePose(x, y, z, checkpoint.yaw, 0.0)
        # Noise that depends on the place only: a resumed run measures what the first run would.
        place = (round(1000 * v) for v in (pose.x, pose.y, pose.z, pose.yaw))
        rng = generator(self._seed, "camera", checkpoint.id, *place)
        look = _Look(self._world, INSTRUMENTS[checkpoint.kind], pose, self._near(checkpoint), rng)
        found = look.search(planned)
        if look.brightest < _DARK:
            raise MeasurementError(f"{checkpoint.name}: too dark")
        if not look.pictures:
            raise PoorViewError(f"{checkpoint.name}: the camera can't get it in view from here")
        if found is None:
            raise PoorViewError(f"{checkpoint.name}: not found")
        reading = look.read(found, planned)
        if reading is None or reading.probability < MIN_CONFIDENCE:
            steep = look.obliqueness > _STEEP
            reason = "seen too obliquely" if steep else "hidden"
            raise PoorViewError(f"{checkpoint.name}: {reason}")
        scale = checkpoint.range
        share = min(max(reading.share, 0.0), 1.0)
        value = round(scale.low + share * (scale.high - scale.low), 3)
        return Measurement(value, look.distance, round(reading.probability, 3))

    def _near(self, checkpoint: SiteCheckpoint) -> tuple[Solid, ...]:
        if checkpoint.id not in self._solids:
            self._solids[checkpoint.id] = solids_near(
                self._world.site, np.array(checkpoint.position), 1.5
            )
        return self._solids[checkpoint.id]


class _Look:
    """One measurement under way. Holds what it has seen."""

    def __init__(
        self,
        world: World,
        instrument: Instrument,
        pose: BodyPose,
        solids: tuple[Solid, ...],
        rng: np.random.Generator,
    ) -> None:
        self._world = world
        self._instrument = instrument
        self._pose = pose
        self._solids = solids
        self._rng = rng
        self._used: list[NDArray[np.float64]] = []
        self._readings: list[PictureReading] = []
        self.pictures = 0
        self.brightest = 1.0
        """of full scale, the bright parts of the brightest picture"""
        self.obliqueness = math.pi / 2
        """rad, of the least oblique look at the face that was found"""
        self.distance = 0.0
        """m, of that look"""

    def search(self, planned: FacePose) -> Fit | None:
        """Finds the face somewhere about where it was planned."""
        best: Fit | None = None
        for turn in _TURNS:
            face = replace(planned, yaw=planned.yaw + turn)
            view = next(self._views(face), None)
            if view is None or not self._is_new(view, planned):
                continue
            photo = self._take(view, MAX_OFFSET + self._face_radius, _SEARCH_PIXELS)
            if self.brightest < _DARK:
                break
            fit = find_face(photo, self._instrument, planned)
            if fit is not None and fit.match > _FOUND:
                self._read(photo, fit)
            if fit is not None and (best is None or fit.match > best.match):
                best = fit
            if best is not None and best.match > _CLEARLY:
                break
        return best if best is not None and best.match > _FOUND else None

    def read(self, found: Fit, planned: FacePose) -> PictureReading | None:
        """Reads the face that was found, from as many views as it takes to be sure."""
        best = found
        for _ in range(_LOOKS):
            view = next(self._views(best.pose), None)
            if view is None:
                break
            photo = self._take(view, self._instrument.extent, _PIXELS)
            fit = look_closer(photo, self._instrument, best.pose)
            if fit.match < _SURELY:
                anew = find_face(photo, self._instrument, planned)
                fit = max((f for f in (fit, anew) if f), key=lambda f: f.match)
            if fit.match > best.match:
                best = fit
            self._read(photo, fit)
            total = combine_readings(self._readings)
            if total is not None and len(self._readings) > 1 and total.probability >= _ENOUGH:
                break
        return combine_readings(self._readings)

    def _read(self, photo: Photo, fit: Fit) -> None:
        """Notes what the indicator shows, the face being found there."""
        sight = photo.pose.position - fit.pose.center
        distance = float(np.linalg.norm(sight))
        cosine = float(sight @ fit.pose.normal) / distance
        obliqueness = math.acos(max(-1.0, min(1.0, cosine)))
        if obliqueness < self.obliqueness:
            self.obliqueness, self.distance = obliqueness, distance
        if fit.match < _SEEN:
            return
        pointing = find_indicator(photo, self._instrument, fit.pose)
        if pointing is not None:
            sure = probability(fit, pointing, cosine)
            self._readings.append(PictureReading(pointing.share, sure))

    def _is_new(self, view: ArmView, planned: FacePose) -> bool:
        """Whether it is not nearly from where the camera has looked before."""
        toward = _direction(view.camera.position, planned)
        return all(toward @ _direction(eye, planned) < math.cos(_SAME) for eye in self._used)

    @property
    def _face_radius(self) -> float:
        return max(self._instrument.shape.half_width, self._instrument.shape.half_height)

    def _views(self, face: FacePose) -> Iterator[ArmView]:
        size = 0.8 * self._instrument.shape.half_width
        return plan_views(self._world, self._pose, face, self._solids, size, self._used, _SPREAD)

    def _take(self, view: ArmView, radius: float, pixels: int) -> Photo:
        """A picture of all within a radius (m) about the middle of the view."""
        half = math.tan(math.asin(min(0.8, radius / view.distance)))
        lens = Lens(pixels, pixels / 2 / half)
        self._world.set_joints(dict(zip(JOINTS, view.joints.tolist(), strict=True)))
        picture = take_picture(self._world, lens, view.camera, self._rng)
        if self._world.on_shot is not None:
            self._world.on_shot(
                Shot(picture, lens.focal, view.camera.position, view.camera.rotation)
            )
        self._used.append(view.camera.position)
        bright = float(np.percentile(picture, 98)) / 255
        self.brightest = bright if not self.pictures else max(self.brightest, bright)
        self.pictures += 1
        return make_photo(picture, lens, view.camera)


def _direction(eye: NDArray[np.float64], face: FacePose) -> NDArray[np.float64]:
    sight = eye - face.center
    return np.asarray(sight / np.linalg.norm(sight))
