"""Camera sensor: it reads checkpoints from pictures that it takes with the camera on the arm."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.base.message import Listing, Message, as_message
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError
from argo_env.sensing.vision.align import FacePose, Fit
from argo_env.sensing.vision.arm import JOINTS
from argo_env.sensing.vision.indicator import (
    PictureReading,
    find_indicator_on_scale,
    find_most_probable_reading,
    reading_probability,
)
from argo_env.sensing.vision.instrument import DIAL, LEVEL, VALVE, Instrument
from argo_env.sensing.vision.locate import find_face, find_face_near
from argo_env.sensing.vision.photo import Lens, Photo, make_photo, take_picture
from argo_env.sensing.vision.views import ArmView, plan_views_cheapest_first, solids_with_box_near
from argo_env.site import SiteCheckpoint
from argo_env.site.shapes import Solid
from argo_env.world.placement import MAX_OFFSET
from argo_env.world.world import Shot, World

INSTRUMENTS = {instrument.kind: instrument for instrument in (DIAL, VALVE, LEVEL)}

MIN_CONFIDENCE = 0.5
"""confidence from which on a reading is returned"""

_SEARCH_PIXELS, _PIXELS = 400, 320  # width and height of a picture
_TURNS = np.radians([0, 55, -55, 80, -80, 20, -20])  # of the face, assumed one after the other
_MAX_CLOSE_PICTURES = 4  # of a face that was found
_SPREAD = math.radians(25)  # between the directions of two pictures, if possible
_SAME_DIRECTION = math.radians(8)  # between two pictures that show the same
_SURE_CONFIDENCE = 0.98  # confidence from which no further picture is taken
_FOUND_MATCH = 0.72  # match from which a face counts as found
_READABLE_MATCH = 0.6  # match from which a picture is read
_SURE_MATCH = 0.92  # match from which a close picture needs no second search
_GOOD_MATCH = 0.86  # match from which the search ends
_DARK_BRIGHTNESS = 0.07  # of full scale: pictures whose bright parts are darker are too dark
_STEEP_OBLIQUENESS = math.radians(62)


class CameraSensor:
    """Sensor that reads checkpoints by camera. It holds the world that it takes pictures of."""

    name = "camera"

    def __init__(self, world: World, seed: int = 0) -> None:
        """Raise ArgoError if OpenCV is not installed, or if the robot's arm can't aim a camera."""
        try:
            import cv2  # noqa: F401
        except ImportError as error:
            raise Unavailable(
                Message(
                    "the sensor `camera` needs OpenCV: {install_line}",
                    install_line=install_line("vision"),
                )
            ) from error
        if missing := [joint for joint in JOINTS if joint not in world.robot.arm_raised]:
            raise Invalid(
                Message(
                    "the sensor `camera` aims an arm with the joints {joints}; robot {robot} "
                    "has no {missing}: use the sensor `ideal`",
                    joints=Listing(JOINTS),
                    robot=world.robot.name,
                    missing=Listing(missing),
                )
            )
        self._world = world
        self._seed = seed
        self._solids: dict[int, tuple[Solid, ...]] = {}

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Read the checkpoint from as many views as a sure reading needs.

        Raises MeasurementError, with a reason, if no reading is sure enough.
        """
        checkpoint = self._world.site.checkpoint(checkpoint_id)
        joints_before = dict(zip(JOINTS, self._world.joint_positions(JOINTS), strict=True))
        try:
            return self._measure(checkpoint, pose)
        finally:
            self._world.set_joints(joints_before)

    def _measure(self, checkpoint: SiteCheckpoint, pose: BodyPose) -> Measurement:
        x, y, z = checkpoint.position
        planned = FacePose(x, y, z, checkpoint.yaw, 0.0)
        # The noise depends on the pose only, so a resumed run measures the same values.
        rounded_pose = (round(1000 * v) for v in (pose.x, pose.y, pose.z, pose.yaw))
        rng = generator(self._seed, "camera", checkpoint.id, *rounded_pose)
        measurement = _CameraMeasurement(
            self._world, INSTRUMENTS[checkpoint.kind], pose, self._solids_near(checkpoint), rng
        )
        fit = measurement.search(planned)
        if measurement.brightest < _DARK_BRIGHTNESS:
            raise MeasurementError(Message("{checkpoint}: too dark", checkpoint=checkpoint.name))
        if not measurement.pictures:
            raise PoorViewError(
                Message(
                    "{checkpoint}: the camera can't get it in view from here",
                    checkpoint=checkpoint.name,
                )
            )
        if fit is None:
            raise PoorViewError(Message("{checkpoint}: not found", checkpoint=checkpoint.name))
        reading = measurement.read(fit, planned)
        if reading is None or reading.probability < MIN_CONFIDENCE:
            steep = measurement.obliqueness > _STEEP_OBLIQUENESS
            reason = Message("seen too obliquely") if steep else Message("hidden")
            raise PoorViewError(
                Message("{name}: {reason}", name=checkpoint.name, reason=as_message(reason))
            )
        scale = checkpoint.range
        share = min(max(reading.share, 0.0), 1.0)
        value = round(scale.low + share * (scale.high - scale.low), 3)
        return Measurement(value, measurement.distance, round(reading.probability, 3))

    def _solids_near(self, checkpoint: SiteCheckpoint) -> tuple[Solid, ...]:
        if checkpoint.id not in self._solids:
            self._solids[checkpoint.id] = solids_with_box_near(
                self._world.site, np.array(checkpoint.position), 1.5
            )
        return self._solids[checkpoint.id]


class _CameraMeasurement:
    """State of one measurement: the views used and the readings made so far."""

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
        """of full scale: brightness of the bright parts of the brightest picture"""
        self.obliqueness = math.pi / 2
        """rad, obliqueness of the least oblique view in which the face was found"""
        self.distance = 0.0
        """m, distance from the camera to the face in this view"""

    def search(self, planned: FacePose) -> Fit | None:
        """Search for the face around its planned pose; return None if it is not found."""
        best: Fit | None = None
        for turn in _TURNS:
            face = replace(planned, yaw=planned.yaw + turn)
            view = next(self._views(face), None)
            if view is None or not self._is_new(view, planned):
                continue
            photo = self._take_photo(view, MAX_OFFSET + self._face_radius, _SEARCH_PIXELS)
            if self.brightest < _DARK_BRIGHTNESS:
                break
            fit = find_face(photo, self._instrument, planned)
            if fit is not None and fit.match > _FOUND_MATCH:
                self._record_reading(photo, fit)
            if fit is not None and (best is None or fit.match > best.match):
                best = fit
            if best is not None and best.match > _GOOD_MATCH:
                break
        return best if best is not None and best.match > _FOUND_MATCH else None

    def read(self, fit: Fit, planned: FacePose) -> PictureReading | None:
        """Read the face that was found, from as many views as a sure reading needs.

        Returns None if no picture can be read.
        """
        best = fit
        for _ in range(_MAX_CLOSE_PICTURES):
            view = next(self._views(best.pose), None)
            if view is None:
                break
            photo = self._take_photo(view, self._instrument.extent, _PIXELS)
            fit = find_face_near(photo, self._instrument, best.pose)
            if fit.match < _SURE_MATCH:
                searched = find_face(photo, self._instrument, planned)
                fit = max((f for f in (fit, searched) if f), key=lambda f: f.match)
            if fit.match > best.match:
                best = fit
            self._record_reading(photo, fit)
            total = find_most_probable_reading(self._readings)
            if (
                total is not None
                and len(self._readings) > 1
                and total.probability >= _SURE_CONFIDENCE
            ):
                break
        return find_most_probable_reading(self._readings)

    def _record_reading(self, photo: Photo, fit: Fit) -> None:
        """Record the reading of the indicator in a picture in which the face was found."""
        sight = photo.pose.position - fit.pose.center
        distance = float(np.linalg.norm(sight))
        cosine = float(sight @ fit.pose.normal) / distance
        obliqueness = math.acos(max(-1.0, min(1.0, cosine)))
        if obliqueness < self.obliqueness:
            self.obliqueness, self.distance = obliqueness, distance
        if fit.match < _READABLE_MATCH:
            return
        indicator = find_indicator_on_scale(photo, self._instrument, fit.pose)
        if indicator is not None:
            probability = reading_probability(fit, indicator, cosine)
            self._readings.append(PictureReading(indicator.share, probability))

    def _is_new(self, view: ArmView, planned: FacePose) -> bool:
        """Return True if the view is in another direction than all pictures taken so far."""
        toward = _direction(view.camera.position, planned)
        return all(
            toward @ _direction(eye, planned) < math.cos(_SAME_DIRECTION) for eye in self._used
        )

    @property
    def _face_radius(self) -> float:
        return max(self._instrument.shape.half_width, self._instrument.shape.half_height)

    def _views(self, face: FacePose) -> Iterator[ArmView]:
        size = 0.8 * self._instrument.shape.half_width
        return plan_views_cheapest_first(
            self._world, self._pose, face, self._solids, size, self._used, _SPREAD
        )

    def _take_photo(self, view: ArmView, radius: float, pixels: int) -> Photo:
        """Take a square picture, `pixels` wide, of all within `radius` (m) of the view's middle."""
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
