"""Campaign: readings of checkpoints by the camera: `python -m tests.campaigns.perception`.

Each trial displaces a checkpoint of UMAD (within a sphere of 10 cm, turned and rolled by up to
±90°), sets a random value of its scale and a light of 0.3 to 1, and reads it from the pose at which
the robot would stop. In a third of the trials a pipe or a board is in between. A checkpoint is
*readable* if, from some view that the arm reaches, in range and at most 60° off the face's normal,
at least 70 % of the face and 70 % of the indicator are in sight. This is computed from geometry
alone, before the reading.
"""

import argparse
import json
import math
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.catalog import CheckpointKind
from argo_env.planning import open_site
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.sensor import MeasurementError
from argo_env.sensing.vision.align import FacePose
from argo_env.sensing.vision.instrument import Instrument
from argo_env.sensing.vision.sensor import INSTRUMENTS, CameraSensor
from argo_env.sensing.vision.views import plan_views_cheapest_first, solids_with_box_near
from argo_env.site.shapes import Box, Cylinder, Solid
from argo_env.world.placement import AS_PLANNED, draw_checkpoint_placement
from argo_env.world.world import World
from benchmarks.options import parse_seed

CERTAIN = 0.9
"""least confidence of a certain reading"""
_OBLIQUE = math.radians(60)
_MIN_IN_SIGHT = 0.7  # share of the face and of the indicator
_TOLERANCES = {  # largest error of a right reading, as a share of the scale
    CheckpointKind.PRESSURE_GAUGE: 0.02,
    CheckpointKind.LIQUID_LEVEL_GAUGE: 0.02,
    CheckpointKind.VALVE: 5 / 90,
}


@dataclass(frozen=True)
class Trial:
    """Result of one trial: a displaced checkpoint and its reading."""

    number: int
    kind: str
    checkpoint: int
    turn: float
    """deg"""
    roll: float
    """deg"""
    light: float
    occluded: bool
    """whether an obstacle was put in between"""
    readable: bool
    error: float | None
    """error as a share of the scale; None: nothing was read"""
    right: bool
    confidence: float
    reason: str | None
    """reason why nothing was read"""
    seconds: float
    """wall time of the reading"""


class Scene:
    """Site with a robot in front of its checkpoints. Owns a world."""

    def __init__(self) -> None:
        self.navigator = open_site("umad").navigator
        self.site = self.navigator.site
        self.world = World(self.site, self.navigator.robot)
        starts = list(self.site.docks.values())
        self.stop_poses = {
            c.id: [self.navigator.plan_to_view(start, c.id).end for start in starts]
            for c in self.site.checkpoints
        }

    def run(self, seed: int, number: int) -> Trial:
        """Run the trial of that number."""
        rng = generator(seed, "perception", number)
        kind = list(CheckpointKind)[int(rng.integers(len(CheckpointKind)))]
        checkpoint = rng.choice([c.id for c in self.site.checkpoints if c.kind is kind])
        planned = self.site.checkpoint(int(checkpoint))
        instrument = INSTRUMENTS[kind]
        stand = self.stop_poses[planned.id][int(rng.integers(2))]
        pose = BodyPose(stand.x, stand.y, stand.z, stand.yaw)
        placement = draw_checkpoint_placement(rng, keep_upright=not instrument.rolled)
        share = float(rng.uniform())
        world = self.world
        world.place_robot(pose)
        world.set_arm_degrees(world.robot.arm_raised)
        world.light = float(rng.uniform(0.3, 1.0))
        world.set_displacement(planned.id, placement)
        scale = planned.range
        world.show_value(planned.id, scale.low + share * (scale.high - scale.low))
        screen = None
        if rng.uniform() < 1 / 3:
            actual = np.array(world.actual_checkpoint(planned.id).position)
            screen = world.add_screen("screen", draw_screen(rng, pose, actual), (0.4, 0.42, 0.45))
        try:
            actual_face = world.actual_checkpoint(planned.id)
            face = FacePose(*actual_face.position, actual_face.yaw, placement.roll)
            readable = self._readable(face, instrument, pose, share)
            begun = time.perf_counter()
            error, confidence, reason = None, 0.0, None
            try:
                measurement = CameraSensor(world, seed=seed + number).measure(planned.id, pose)
                error = (measurement.value - scale.low) / (scale.high - scale.low) - share
                confidence = measurement.confidence
            except MeasurementError as failure:
                reason = str(failure).split(": ", 1)[1]
            seconds = time.perf_counter() - begun
        finally:
            world.set_displacement(planned.id, AS_PLANNED)
            if screen is not None:
                world.remove_screen(screen)
        return Trial(
            number, kind.value, planned.id,
            math.degrees(placement.turn), math.degrees(placement.roll), world.light,
            screen is not None, readable, error,
            error is not None and abs(error) <= _TOLERANCES[kind], confidence, reason, seconds,
        )  # fmt: skip

    def _readable(
        self, face: FacePose, instrument: Instrument, pose: BodyPose, share: float
    ) -> bool:
        """Return True if face and indicator are in sight from some view, by geometry alone."""
        solids = solids_with_box_near(self.site, face.center, 1.5)
        size = 0.8 * instrument.shape.half_width
        indicator = instrument.indicator
        position = indicator.low + share * (indicator.high - indicator.low)
        moved = indicator.move(indicator.body, np.array([position]))[0]
        front = np.array([0.012, 0.0, 0.0])
        hand = face.to_site(moved * np.array([0.0, 1.0, 1.0]) + front)
        plate = face.to_site(face_points(instrument) + front)
        for view in plan_views_cheapest_first(self.world, pose, face, solids, size, (), 1.0):
            if view.obliqueness > _OBLIQUE:
                continue
            eye = view.camera.position
            if min(self._in_sight(eye, plate), self._in_sight(eye, hand)) >= _MIN_IN_SIGHT:
                return True
        return False

    def _in_sight(self, eye: NDArray[np.float64], points: NDArray[np.float64]) -> float:
        x, y, z = eye.tolist()
        return float(np.isinf(self.world.hit_distances_or_inf((x, y, z), points)).mean())


def face_points(instrument: Instrument) -> NDArray[np.float64]:
    """Return points spread over a face, in the instrument's frame, shape (n, 3)."""
    shape = instrument.shape
    y, z = np.meshgrid(np.linspace(-0.95, 0.95, 12), np.linspace(-0.95, 0.95, 12))
    inside = np.hypot(y, z) < 0.95 if shape.round else np.ones(y.shape, dtype=bool)
    return np.column_stack(
        [np.zeros(inside.sum()), y[inside] * shape.half_width, z[inside] * shape.half_height]
    )


def draw_screen(rng: np.random.Generator, pose: BodyPose, target: NDArray[np.float64]) -> Solid:
    """Draw a pipe or a board between the robot's raised camera and a point."""
    camera = np.array([pose.x, pose.y, pose.z + 1.15])
    line = target - camera
    side = np.array([-line[1], line[0], 0.0]) / np.hypot(line[0], line[1])
    position = camera + rng.uniform(0.4, 0.8) * line + rng.uniform(-0.12, 0.12) * side
    x, y, z = (position + np.array([0.0, 0.0, rng.uniform(-0.12, 0.12)])).tolist()
    turn = (0.0, float(rng.uniform(-math.pi, math.pi)), math.atan2(line[1], line[0]) + 1.57)
    if rng.uniform() < 0.5:
        return Cylinder((x, y, z), float(rng.uniform(0.01, 0.03)), 0.8, turn)
    return Box(
        (x, y, z), (float(rng.uniform(0.04, 0.14)), 0.012, float(rng.uniform(0.1, 0.3))), turn
    )


@cache
def open_scene() -> Scene:
    """Return the scene of this process, made at the first call."""
    import cv2

    cv2.setNumThreads(1)  # the processes share the cores
    return Scene()


def run_trial(seed: int, number: int) -> Trial:
    """Run the trial of that number in the scene of this process."""
    return open_scene().run(seed, number)


def run_trials(seed: int, count: int, jobs: int) -> Iterator[Trial]:
    """Yield the results of all trials in order."""
    # Not forked: OpenCV's threads may hold locks that a forked process would wait for.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(partial(run_trial, seed), range(count))


def report_lines(trials: Sequence[Trial]) -> Iterator[str]:
    """Yield the lines of the report."""

    def rate(part: int, whole: int) -> str:
        return f"{part} of {whole} ({100 * part / whole:.1f} %)" if whole else "none"

    groups = [("all", list(trials))]
    groups += [(k.value, [t for t in trials if t.kind == k.value]) for k in CheckpointKind]
    groups += [("with an obstacle", [t for t in trials if t.occluded])]
    for name, group in groups:
        readable = [t for t in group if t.readable]
        right = [t for t in readable if t.right]
        yield (
            f"{name}: readable {rate(len(readable), len(group))}, of these read correctly "
            + rate(len(right), len(readable))
        )
    read = [t for t in trials if t.error is not None]
    certain = [t for t in read if t.confidence >= CERTAIN]
    wrong = [t for t in certain if not t.right]
    rest = [t for t in trials if not t.readable]
    yield f"certain readings (confidence from {CERTAIN}): {len(certain)}, of these wrong " + rate(
        len(wrong), len(certain)
    )
    yield f"wrong readings: {rate(sum(not t.right for t in read), len(read))} of all readings"
    refused = sum(t.error is None for t in rest)
    correct = sum(t.right for t in rest)
    yield (
        f"not readable: {len(rest)}: refused {refused}, read correctly all the same {correct}, "
        + f"wrong {len(rest) - refused - correct}"
    )
    for low, high in ((0.5, 0.7), (0.7, 0.9), (0.9, 0.98), (0.98, 1.01)):
        band = [t for t in read if low <= t.confidence < high]
        share = rate(sum(t.right for t in band), len(band))
        yield f"confidence {low} to {min(high, 1.0)}: correct {share}"
    for kind in CheckpointKind:
        errors = [abs(t.error) for t in read if t.kind == kind.value and t.error is not None]
        if errors:
            yield f"median error, {kind.value}: {100 * float(np.median(errors)):.2f} % of the scale"
    reasons = sorted({t.reason for t in trials if t.reason})
    for reason in reasons:
        yield f"refused as: {reason}: {sum(t.reason == reason for t in trials)}"
    seconds = [t.seconds for t in trials]
    slow = np.quantile(seconds, 0.95)
    yield f"time for a reading: median {np.median(seconds):.2f} s, 95 % {slow:.2f} s"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the trials and print the report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--seed", type=parse_seed, default=2018, help="seed; default: that of docs/perception.md"
    )
    parser.add_argument("--trials", type=int, default=600, help="number of trials")
    parser.add_argument("--jobs", type=int, default=2, help="number of processes")
    parser.add_argument("--out", type=Path, help="file for the trials, one line of JSON each")
    options = parser.parse_args(arguments)
    trials = []
    with options.out.open("w", encoding="utf-8") if options.out else nullcontext() as file:
        for trial in run_trials(options.seed, options.trials, options.jobs):
            trials.append(trial)
            if file:
                file.write(json.dumps(asdict(trial)) + "\n")
                file.flush()
    print(f"{len(trials)} trials, seed {options.seed}")
    for line in report_lines(trials):
        print(line)


if __name__ == "__main__":
    main()
