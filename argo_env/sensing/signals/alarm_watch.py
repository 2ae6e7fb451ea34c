"""Watch for the general platform alarm, recognized by its tone and by the beat of the tone."""

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.microphone import Microphone
from argo_env.sensing.watch import Detection, ReportedDetection
from argo_env.surroundings.sound import ALARM_ON, ALARM_PERIOD, ALARM_TONE, RATE

RECORDING = 0.05  # s
TONE_BAND = 20.0  # Hz to both sides of the tone
NOISE_BAND = (600.0, 1600.0)  # Hz, in which the noise beside the tone is measured
PROMINENCE = 20.0
"""dB over the mean of the noise; one of three lines of white noise exceeds it with a probability of
3 e^-100"""
BEAT_RECORDINGS, MAX_MISMATCHES = 10, 1
"""recordings that are compared with the beat, and how many of them may differ from it"""
MIN_TONE = 0.01  # s of tone in a recording from which it is detected
IDLE_UPDATES = 2  # updates per recording while there is no tone
CLEAR_TIME = 6.0  # s without the tone, and without noise that hides it, until the alarm is over
HIDING = 6.0  # dB by which the loudest tone must exceed what is needed, or else noise may hide it
_PHASES = np.arange(0.0, ALARM_PERIOD, 0.02)


def tone_and_needed_power(samples: NDArray[np.float32]) -> tuple[float, float]:
    """Return the power of the line at the alarm's tone, and the power above which it is the tone.

    `samples` is a recording (Pa, `RATE` samples a second).
    """
    bins_per_hertz = len(samples) / RATE
    first, last = round(NOISE_BAND[0] * bins_per_hertz), round(NOISE_BAND[1] * bins_per_hertz)
    spectrum = np.fft.rfft(samples)[first:last]
    power = spectrum.real**2 + spectrum.imag**2
    low, high = (
        round((ALARM_TONE - TONE_BAND) * bins_per_hertz),
        round((ALARM_TONE + TONE_BAND) * bins_per_hertz) + 1,
    )
    tone = power[low - first : high - first]
    noise = (power.sum() - tone.sum()) / (len(power) - len(tone))
    return float(tone.max()), float(10 ** (PROMINENCE / 10) * noise)


def matches_alarm_beat(recordings: Sequence[tuple[float, bool]]) -> bool:
    """Return True if recordings match the beat of an alarm that began at any time.

    Each recording is given as its start time (s), and True if it has the tone. At most
    `MAX_MISMATCHES` of them may differ from the beat. The result is False for fewer than
    `BEAT_RECORDINGS`.
    """
    if len(recordings) < BEAT_RECORDINGS:
        return False
    into_period = (np.array([t for t, _ in recordings])[:, None] - _PHASES) % ALARM_PERIOD
    until_off = np.clip(ALARM_ON - into_period, 0.0, RECORDING)
    from_on = np.clip(into_period + RECORDING - ALARM_PERIOD, 0.0, RECORDING)
    expected = until_off + from_on > MIN_TONE
    wrong = (expected != np.array([has_tone for _, has_tone in recordings])[:, None]).sum(axis=0)
    return bool(wrong.min() <= MAX_MISMATCHES)


class AlarmWatch:
    """Watch for the start and the end of the alarm. It holds the last recordings' results.

    Near a pump, a weak alarm can't be heard: silence counts only where the tone, as loud as it was,
    would stand out.
    """

    name = "alarm"
    period = 0.4

    def __init__(self, microphone: Microphone) -> None:
        self._microphone = microphone
        self._recordings: deque[tuple[float, bool]] = deque(maxlen=BEAT_RECORDINGS)
        self._last_tone: float | None = None  # s, of the last tone, or of noise that may hide it
        self.loudest: float | None = None
        """power of the loudest tone since the alarm began; None: there was none"""
        self._reported = False
        self._idle_updates = 0

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:
        self._reported = bool(reported) and reported[-1].kind is EventKind.PLATFORM_ALARM
        self._last_tone = now if self._reported else None

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        # Record less often while there is no tone, to save time.
        self._idle_updates = (self._idle_updates + 1) % IDLE_UPDATES
        if self._idle_updates != 1 and not any(has_tone for _, has_tone in self._recordings):
            return ()
        power, needed = tone_and_needed_power(self._microphone.record_sound(now, pose, RECORDING))
        tone = power > needed
        self._recordings.append((now, tone))
        if tone:
            self.loudest = max(power, self.loudest or 0.0)
        if tone or (self.loudest is not None and self.loudest < 10 ** (HIDING / 10) * needed):
            self._last_tone = now
        if not self._reported and tone and matches_alarm_beat(self._recordings):
            self._reported = True
            return (
                Detection(EventKind.PLATFORM_ALARM, Message("the general platform alarm sounds")),
            )
        if self._reported and self._last_tone is not None and now - self._last_tone >= CLEAR_TIME:
            self._reported = False
            self._recordings.clear()
            self.loudest = None
            return (Detection(EventKind.ALL_CLEAR, Message("the general platform alarm is over")),)
        return ()
