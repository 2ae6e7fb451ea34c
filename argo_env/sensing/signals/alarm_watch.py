"""The watch for the general platform alarm: its tone, and the beat of it."""

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.microphone import Microphone
from argo_env.sensing.watch import Detection, Told
from argo_env.surroundings.sound import ALARM_ON, ALARM_PERIOD, ALARM_TONE, RATE

RECORDING = 0.05  # s
TONE_BAND = 20.0  # Hz to both sides of the tone
AROUND = (600.0, 1600.0)  # Hz, where the noise beside the tone is taken from
PROMINENCE = 20.0
"""dB over the mean of the noise; white noise gets there in one of three lines with 3 e^-100"""
LOOKS, MISMATCHES = 10, 1
"""recordings that must fit the beat, and how many of them may not"""
SHORTEST = 0.01  # s of tone in a recording from which it shows
IDLE = 2  # looks of which it takes one while there is nothing to hear
CLEAR_TIME = 6.0  # s without the tone until the alarm is over
_PHASES = np.arange(0.0, ALARM_PERIOD, 0.02)


def hears_tone(samples: NDArray[np.float32]) -> bool:
    """Whether the alarm's tone stands out of a recording."""
    line = len(samples) / RATE  # bins a hertz
    first, last = round(AROUND[0] * line), round(AROUND[1] * line)
    spectrum = np.fft.rfft(samples)[first:last]
    power = spectrum.real**2 + spectrum.imag**2
    low, high = round((ALARM_TONE - TONE_BAND) * line), round((ALARM_TONE + TONE_BAND) * line) + 1
    tone = power[low - first : high - first]
    noise = (power.sum() - tone.sum()) / (len(power) - len(tone))
    return bool(tone.max() > 10 ** (PROMINENCE / 10) * noise)


def fits_beat(heard: Sequence[tuple[float, bool]]) -> bool:
    """Whether times (s) with and without the tone are those of the alarm, whenever it began."""
    if len(heard) < LOOKS:
        return False
    into = (np.array([t for t, _ in heard])[:, None] - _PHASES) % ALARM_PERIOD
    until_off = np.clip(ALARM_ON - into, 0.0, RECORDING)
    from_on = np.clip(into + RECORDING - ALARM_PERIOD, 0.0, RECORDING)
    expected = until_off + from_on > SHORTEST
    wrong = (expected != np.array([on for _, on in heard])[:, None]).sum(axis=0)
    return bool(wrong.min() <= MISMATCHES)


class AlarmWatch:
    """Tells that the alarm sounds, and that it is over. Holds what it has heard last."""

    name = "alarm"
    period = 0.4

    def __init__(self, microphone: Microphone) -> None:
        self._microphone = microphone
        self._heard: deque[tuple[float, bool]] = deque(maxlen=LOOKS)
        self._last_tone: float | None = None
        self._told = False
        self._idle = 0

    def remember(self, told: Sequence[Told], now: float) -> None:
        self._told = bool(told) and told[-1].kind is EventKind.PLATFORM_ALARM
        self._last_tone = now if self._told else None

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        # It listens less often while there is nothing to hear.
        self._idle = (self._idle + 1) % IDLE
        if self._idle != 1 and not any(on for _, on in self._heard):
            return ()
        tone = hears_tone(self._microphone.record(now, pose, RECORDING))
        self._heard.append((now, tone))
        if tone:
            self._last_tone = now
        if not self._told and tone and fits_beat(self._heard):
            self._told = True
            return (Detection(EventKind.PLATFORM_ALARM, "the general platform alarm sounds"),)
        if self._told and self._last_tone is not None and now - self._last_tone >= CLEAR_TIME:
            self._told = False
            self._heard.clear()
            return (Detection(EventKind.ALL_CLEAR, "the general platform alarm is over"),)
        return ()
