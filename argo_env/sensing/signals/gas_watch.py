"""Watch for gas leaks, with its two instruments: a gas sensor and an ultrasonic microphone."""

import math
import statistics
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from argo_compiler.base.message import Listing, Message
from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.frames import NOSE, to_rounded_vector, to_site
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.watch import Detection, ReportedDetection
from argo_env.site.shapes import Vector
from argo_env.surroundings import GasLeak, Surroundings
from argo_env.surroundings.gas import concentration
from argo_env.surroundings.sound import leak_level
from argo_env.world.world import World


class GasSensor:
    """Point sensor for methane. It holds its delayed display value and the drift of its zero."""

    T90 = 5.0
    """s until the sensor shows 90 % of a step in concentration"""
    NOISE = 2.0
    """ppm, standard deviation"""
    DRIFT = 3.0
    """ppm, standard deviation of the zero, which drifts"""
    DRIFT_TIME = 600.0
    """s, time constant of the zero's autocorrelation"""
    BACKGROUND = 1.9
    """ppm of methane in clean air"""
    GUSTS = 0.4
    """standard deviation of the logarithm of the factor by which eddies change the mean
    concentration"""

    def __init__(self, surroundings: Surroundings, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._rng = rng
        self._shown = self.BACKGROUND
        self._zero = self.DRIFT * float(rng.standard_normal())
        self._last: float | None = None

    def measure_methane_ppm(self, now: float, pose: BodyPose) -> float:
        """Return the concentration of methane that the sensor shows at time `now` (s), in ppm.

        The sensor lags behind the air at the robot's nose: each call continues from the last one.
        """
        step = 0.0 if self._last is None else now - self._last
        self._last = now
        noise, drift, gust = map(float, self._rng.standard_normal(3))
        at = to_site(pose, NOSE)[None, :]
        surroundings, ground = self._surroundings, self._surroundings.site.spec.ground_z
        mean = math.fsum(
            float(concentration(release, surroundings.weather, ground, at, now)[0])
            for release in surroundings.releases
        )
        air = self.BACKGROUND + mean * math.exp(self.GUSTS * gust - self.GUSTS**2 / 2)
        self._shown += (air - self._shown) * (1 - math.exp(-step * math.log(10) / self.T90))
        share_kept = math.exp(-step / self.DRIFT_TIME)
        self._zero = share_kept * self._zero + self.DRIFT * math.sqrt(1 - share_kept**2) * drift
        return self._shown + self._zero + self.NOISE * noise


class UltrasonicMicrophone:
    """Microphone for the sound level in the band about 40 kHz."""

    BACKGROUND = 45.0
    """dB"""
    NOISE = 1.5
    """dB, standard deviation"""
    BANG_SHARE = 0.01
    """share of the readings in which metal strikes metal somewhere"""
    BANG = (60.0, 90.0)
    """dB, lowest and highest level of such a bang"""

    def __init__(self, surroundings: Surroundings, world: World, rng: np.random.Generator) -> None:
        self._surroundings = surroundings
        self._world = world
        self._rng = rng

    def measure_level(self, pose: BodyPose) -> float:
        """Return the measured sound level in the band about 40 kHz, in dB.

        It has noise, and at times a bang of metal on metal.
        """
        noise = float(self._rng.standard_normal())
        bang, height = map(float, self._rng.random(2))
        levels = [self.BACKGROUND]
        if bang < self.BANG_SHARE:
            levels.append(self.BANG[0] + height * (self.BANG[1] - self.BANG[0]))
        for source in self._surroundings.sources:
            if isinstance(source, GasLeak):
                levels.append(self._received_level(source, pose))
        return 10 * math.log10(sum(10 ** (level / 10) for level in levels)) + self.NOISE * noise

    def _received_level(self, leak: GasLeak, pose: BodyPose) -> float:
        microphone = to_site(pose, NOSE)
        sight = np.array(leak.place) - microphone
        distance = float(np.linalg.norm(sight))
        # The leak lies in the surface of the leaking part, which therefore is no obstacle.
        range_to_solid = self._world.hit_distances_or_inf(
            to_rounded_vector(microphone), np.array([leak.place])
        )[0]
        return leak_level(leak, distance, bool(range_to_solid < distance - 0.2))


GAS_ON, GAS_OFF = 40.0, 20.0
"""ppm from which there is gas, and below which there is none; without a leak the sensor shows
1.9 ppm, with a standard deviation of 3.6 ppm from noise and drift"""
HISS_ON, HISS_OFF = 62.0, 55.0
"""dB from which there is a hiss, and below which there is none"""
VOTERS, GAS_VOTES, HISS_VOTES = 5, 3, 4
"""number of the last readings, and how many of them must be high for gas and for a hiss; a bang
lasts for one reading only"""
WARMING_UP = 15.0  # s after a run is resumed until the sensors show a leak that has gone on
SAME_LEAK = 8.0  # m from where a leak was sensed within which a signal belongs to it
SAME_PLACE = 0.02
"""m between positions of the robot's nose at one place; farther apart, a solid may hide the hiss at
one of them, or a narrow plume may pass it by"""
SIGNAL_READINGS, CLEAR_READINGS = 10, 30
"""numbers of readings at a standstill, one a second, whose mean shows that there is a leak, and
that there is none any more"""
NO_GAS = 10.0
"""ppm, largest mean of `CLEAR_READINGS` readings that shows that there is no gas"""


class Hysteresis:
    """Switch with hysteresis. It holds the last values and whether it is on.

    It goes on when `votes` of the last `VOTERS` values are `on` or more, and off when all of them
    are less than `off`.
    """

    def __init__(self, on: float, off: float, votes: int) -> None:
        self._limits = (on, off)
        self._votes = votes
        self._values: deque[float] = deque(maxlen=VOTERS)
        self.active = False

    def update(self, value: float) -> bool:
        """Add a value, and return True if the switch is on now."""
        self._values.append(value)
        on, off = self._limits
        if sum(v >= on for v in self._values) >= self._votes:
            self.active = True
        elif all(v < off for v in self._values):
            self.active = False
        return self.active


class _Standstill:
    """Stay at one place. It holds the last readings there, and where the robot's nose is."""

    def __init__(self, nose: Vector) -> None:
        self.nose = nose
        self._ppm: deque[float] = deque(maxlen=CLEAR_READINGS)
        self._level: deque[float] = deque(maxlen=CLEAR_READINGS)
        self._without_signal = 0

    def add(self, ppm: float, level: float, has_signal: bool) -> None:
        """Add the readings of a second: of gas, without the sensor's delay, and of hiss in dB.

        `has_signal` is True if the last readings together show gas or a hiss.
        """
        self._ppm.append(ppm)
        self._level.append(level)
        self._without_signal = 0 if has_signal else self._without_signal + 1

    @property
    def strength(self) -> float:
        """Mean signal relative to the limit from which there is gas or a hiss; 0 if it is short."""
        if len(self._ppm) < SIGNAL_READINGS:
            return 0.0
        ppm, level = (list(values)[-SIGNAL_READINGS:] for values in (self._ppm, self._level))
        # A bang of metal on metal changes a mean, but not the median.
        hiss = 10 ** ((statistics.median(level) - HISS_ON) / 10)
        return max(statistics.fmean(ppm) / GAS_ON, hiss)

    @property
    def is_quiet(self) -> bool:
        """True if `CLEAR_READINGS` readings show neither gas nor hiss, each and in the mean."""
        return (
            self._without_signal >= CLEAR_READINGS
            and statistics.fmean(self._ppm) < NO_GAS
            and statistics.median(self._level) < HISS_OFF
        )


@dataclass
class _Leak:
    """A leak that was reported: the poses at which it was sensed, and its reference place."""

    poses: list[BodyPose]
    """apart from each other by more than `SAME_LEAK`"""
    reference: Vector | None = None
    """m, position of the nose where the robot stood in the strongest signal; None: nowhere yet"""
    strength: float = 1.0
    """of the signal there (`_Standstill.strength`)"""


class GasWatch:
    """Watch for gas leaks. It holds the last readings and the leaks that it has reported.

    It reports each leak once. It reports the all-clear once the robot has stood without a signal
    wherever a reported leak was strongest, of the places at which the robot stood in its signal.
    """

    name = "gas"
    period = 1.0

    def __init__(self, gas: GasSensor, microphone: UltrasonicMicrophone, site_map: SiteMap) -> None:
        self._gas_sensor = gas
        self._microphone = microphone
        self._map = site_map
        self._gas = Hysteresis(GAS_ON, GAS_OFF, GAS_VOTES)
        self._hiss = Hysteresis(HISS_ON, HISS_OFF, HISS_VOTES)
        self._reported: list[_Leak] = []
        self._current: _Leak | None = None
        self._last: tuple[float, float] | None = None  # s and ppm, of the last reading of gas
        self._standstill: _Standstill | None = None
        self._valid_from = 0.0  # s, from when on silence means that there is no leak

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:
        """Restore the leaks that were reported before the last all-clear.

        Where the robot stood in their signals is unknown, so an all-clear needs new signals.

        Before `now` + `WARMING_UP` (s), the absence of gas and hiss does not mean that a leak has
        been left behind.
        """
        for detection in reported:
            if detection.kind is EventKind.GAS_LEAK:
                self._reported.append(_Leak([detection.pose]))
            else:
                self._reported.clear()
        self._current = self._reported[-1] if self._reported else None
        self._valid_from = now + WARMING_UP

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        ppm, level = (
            self._gas_sensor.measure_methane_ppm(now, pose),
            self._microphone.measure_level(pose),
        )
        has_gas, has_hiss = self._gas.update(ppm), self._hiss.update(level)
        standstill = self._standstill_at(pose)
        standstill.add(self._undelayed(now, ppm), level, has_gas or has_hiss)
        if not has_gas and not has_hiss:
            if now >= self._valid_from:
                self._current = None
            return self._all_clear(standstill, pose)
        # A signal without a break belongs to one leak, however far its gas reaches.
        known = self._current or next((k for k in self._reported if _is_near(k, pose)), None)
        self._current = known or _Leak([])
        if not _is_near(self._current, pose):
            self._current.poses.append(pose)
        if standstill.strength >= self._current.strength:
            self._current.reference = standstill.nose
            self._current.strength = standstill.strength
        if known:
            return ()
        self._reported.append(self._current)
        near = self._map.nearest_equipment((pose.x, pose.y, pose.z + 0.5))
        signs = [Message("gas, {ppm:.0f} ppm", ppm=ppm)] * has_gas + [
            Message("a hiss, {level:.0f} dB at 40 kHz", level=level)
        ] * has_hiss
        detail = Message("{signs:and}, near {near}", signs=Listing(signs), near=near)
        return (Detection(EventKind.GAS_LEAK, detail, noticed_from=_position(pose)),)

    def _standstill_at(self, pose: BodyPose) -> _Standstill:
        """Return the present stay, a new one if the nose has moved."""
        nose = to_rounded_vector(to_site(pose, NOSE))
        if self._standstill is None or not _is_same_place(self._standstill.nose, nose):
            self._standstill = _Standstill(nose)
        return self._standstill

    def _undelayed(self, now: float, ppm: float) -> float:
        """Return the reading without the delay, by which it still shows the gas of other places."""
        before, shown = self._last or (now, ppm)
        self._last = now, ppm
        if now <= before:
            return ppm
        return shown + (ppm - shown) / (1 - 10 ** ((before - now) / GasSensor.T90))

    def _all_clear(self, standstill: _Standstill, pose: BodyPose) -> tuple[Detection, ...]:
        over = [
            leak
            for leak in self._reported
            if leak.reference is not None
            and standstill.is_quiet
            and _is_same_place(leak.reference, standstill.nose)
        ]
        if not over:
            return ()
        self._reported = [leak for leak in self._reported if leak not in over]
        if self._reported:
            return ()
        detail = Message("there is no gas any more where it was")
        return (Detection(EventKind.ALL_CLEAR, detail, noticed_from=_position(pose)),)


def _is_same_place(a: Vector, b: Vector) -> bool:
    return math.dist(a, b) <= SAME_PLACE


def _position(pose: BodyPose) -> Vector:
    return pose.x, pose.y, pose.z


def _is_near(leak: _Leak, pose: BodyPose) -> bool:
    return any(_distance(pose, where) <= SAME_LEAK for where in leak.poses)


def _distance(a: BodyPose, b: BodyPose) -> float:
    """Return the distance in m, with heights counted three times: other storeys are far away."""
    return math.dist((a.x, a.y, 3 * a.z), (b.x, b.y, 3 * b.z))
