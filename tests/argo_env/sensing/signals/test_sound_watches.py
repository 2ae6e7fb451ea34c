"""Faulty pumps are named by their sound, and the alarm is recognized by its tone and its beat."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.alarm_watch import (
    BEAT_RECORDINGS,
    RECORDING,
    AlarmWatch,
    matches_alarm_beat,
    tone_and_needed_power,
)
from argo_env.sensing.signals.microphone import Microphone, pump_positions
from argo_env.sensing.signals.pump_watch import PumpWatch
from argo_env.sensing.watch import ReportedDetection
from argo_env.surroundings import Alarm, PumpFault, PumpSound, Surroundings
from argo_env.surroundings.sound import ALARM_TONE, RATE, alarm_sound
from tests.argo_env.sensing.signals.plant import Z, detections_along, lane
from tests.conftest import examples

BESIDE = BodyPose(3.0, 3.0, Z, 0.5)


def pump_watch(site, seed=0):
    surroundings = Surroundings(site)
    return PumpWatch(Microphone(surroundings, np.random.default_rng(seed)), site), surroundings


def alarm_watch(site, seed=0):
    surroundings = Surroundings(site)
    return AlarmWatch(Microphone(surroundings, np.random.default_rng(seed))), surroundings


def detections_at(watch, seconds, start=0.0, pose=BESIDE):
    count = round(seconds / watch.period)
    times = [start + k * watch.period for k in range(count)]
    return [(t, f) for t in times for f in watch.update(t, pose)]


def poses_past(place, side, length, heading):
    """Return poses 0.8 m apart along a line that passes a point (m) `side` (m) to its left."""
    c, s = math.cos(heading), math.sin(heading)
    x, y = place[0] - side * s, place[1] + side * c
    steps = np.arange(-length / 2, length / 2, 0.8)
    return [BodyPose(x + t * c, y + t * s, 0.0, heading) for t in steps.tolist()]


def reported_pumps(watch, poses):
    detections = [f for k, pose in enumerate(poses) for f in watch.update(k * watch.period, pose)]
    assert all(f.kind is EventKind.ABNORMAL_SOUND for f in detections)
    return [(f.detail.split(" sounds ")[0], "bearing" in f.detail, f.place) for f in detections]


@pytest.mark.parametrize("fault", PumpFault)
@pytest.mark.parametrize("name", [f"pump P-30{k}" for k in range(1, 5)])
@settings(deadline=None, max_examples=examples(6))
@given(st.floats(0.8, 1.8), st.floats(0, 2 * math.pi), st.integers(0, 999))
def test_passing_a_pump_with_a_fault_that_pump_is_named_and_no_other(
    umad, name, fault, side, heading, seed
):
    places = pump_positions(umad)
    watch, surroundings = pump_watch(umad, seed)
    # Pass the other pumps first and last: the fault heard there is not theirs.
    others = [p for n, p in places.items() if n != name]
    tour = [pose for p in others for pose in poses_past(p, 1.2, 6.0, heading)]
    poses = poses_past(places[name], side, 9.0, heading)
    assert reported_pumps(watch, [*tour, *poses]) == []
    surroundings.add(PumpSound(name, fault))
    bearing = fault is PumpFault.BEARING
    assert reported_pumps(watch, [*tour, *poses, *tour]) == [(name, bearing, places[name])]


@settings(deadline=None, max_examples=examples(6))
@given(st.permutations([f"pump P-30{k}" for k in range(1, 5)]), st.integers(0, 999))
def test_two_pumps_with_faults_are_both_named(umad, names, seed):
    places = pump_positions(umad)
    watch, surroundings = pump_watch(umad, seed)
    surroundings.add(PumpSound(names[0], PumpFault.BEARING))
    surroundings.add(PumpSound(names[1], PumpFault.CAVITATION))
    poses = [
        pose
        for turn in (0.3, 2.0)
        for p in places.values()
        for pose in poses_past(p, 1.0, 9.0, turn)
    ]
    assert sorted(n for n, *_ in reported_pumps(watch, poses)) == sorted(names[:2])


@pytest.mark.parametrize("fault", PumpFault)
@settings(deadline=None, max_examples=examples(4))
@given(st.floats(0, 2 * math.pi), st.integers(0, 99))
def test_close_beside_a_pump_a_fault_is_reported_again_only_after_it_was_gone(
    site, fault, turn, seed
):
    name = "pump P-1"
    x, y, _ = pump_positions(site)[name]
    pose = BodyPose(x + 0.9 * math.cos(turn) - 0.4, y + 0.9 * math.sin(turn), Z, 0.0)
    watch, surroundings = pump_watch(site, seed)
    assert detections_at(watch, 40.0, pose=pose) == []
    for start in (40.0, 80.0):
        surroundings.add(PumpSound(name, fault))
        ((_, detection),) = detections_at(watch, 20.0, start, pose)
        assert detection.detail.startswith(name)
        surroundings.remove(PumpSound(name, fault))
        assert detections_at(watch, 20.0, start + 20.0, pose) == []


@settings(deadline=None, max_examples=examples(6))
@given(st.sampled_from(PumpFault), st.integers(0, 99))
def test_a_position_between_two_pumps_names_neither(site, fault, seed):
    first, second = (np.array(p) for p in pump_positions(site).values())
    x, y, _ = ((first + second) / 2).tolist()
    watch, surroundings = pump_watch(site, seed)
    surroundings.add(PumpSound("pump P-2", fault))
    assert detections_at(watch, 40.0, pose=BodyPose(x - 0.4, y, Z, 0.0)) == []


def test_far_from_pumps_it_does_not_listen(site):
    watch, surroundings = pump_watch(site)
    surroundings.add(PumpSound("pump P-1"))
    assert detections_at(watch, 40.0, pose=BodyPose(15.0, 0.0, Z, 0.0)) == []


@settings(deadline=None, max_examples=examples(8))
@given(st.floats(0.0, 30.0), st.integers(0, 99))
def test_the_start_and_the_end_of_the_alarm_are_reported(site, start, seed):
    watch, surroundings = alarm_watch(site, seed)
    assert detections_at(watch, start) == []
    alarm_start = round(start / watch.period) * watch.period
    surroundings.add(Alarm(), alarm_start)
    ((time, detection),) = detections_at(watch, 12.0, alarm_start)
    assert detection.kind is EventKind.PLATFORM_ALARM
    assert time - alarm_start < 8.0
    surroundings.remove(Alarm(), alarm_start + 12.0)
    ((_, detection),) = detections_at(watch, 12.0, alarm_start + 12.0)
    assert detection.kind is EventKind.ALL_CLEAR


@pytest.mark.parametrize("level", [60.0, 64.0])
def test_a_weak_alarm_that_noise_hides_is_not_over(site, level):
    watch, surroundings = alarm_watch(site)
    surroundings.add(Alarm(level), 0.0)
    away, near = BodyPose(-30.0, 2.0, Z, 0.0), BodyPose(3.0, 4.6, Z, 0.0)
    found = detections_at(watch, 120.0, 0.0, away) + detections_at(watch, 240.0, 120.0, near)
    assert [f.kind for _, f in found] == [EventKind.PLATFORM_ALARM]


def test_a_weak_alarm_that_noise_hides_is_not_over_when_the_run_is_resumed(site):
    watch, surroundings = alarm_watch(site)
    surroundings.add(Alarm(60.0), 0.0)
    assert len(detections_at(watch, 120.0, 0.0, BodyPose(-30.0, 2.0, Z, 0.0))) == 1
    again, surroundings = alarm_watch(site)
    surroundings.add(Alarm(60.0), 0.0)
    again.restore([ReportedDetection(EventKind.PLATFORM_ALARM, BESIDE)], 120.0)
    again.loudest = watch.loudest
    assert detections_at(again, 120.0, 120.0, BodyPose(3.0, 4.6, Z, 0.0)) == []


def test_an_alarm_that_is_over_before_the_run_is_resumed(site):
    watch, _ = alarm_watch(site)
    watch.restore([ReportedDetection(EventKind.PLATFORM_ALARM, BESIDE)], 100.0)
    ((_, detection),) = detections_at(watch, 30.0, 100.0)
    assert detection.kind is EventKind.ALL_CLEAR
    watch, _ = alarm_watch(site)
    watch.restore(
        [ReportedDetection(k, BESIDE) for k in (EventKind.PLATFORM_ALARM, EventKind.ALL_CLEAR)], 100
    )
    assert detections_at(watch, 30.0, 100.0) == []


def test_an_alarm_that_still_sounds_when_the_run_is_resumed(site):
    watch, surroundings = alarm_watch(site)
    surroundings.add(Alarm(), 80.0)
    watch.restore([ReportedDetection(EventKind.PLATFORM_ALARM, BESIDE)], 100.0)
    assert detections_at(watch, 20.0, 100.0) == []
    surroundings.remove(Alarm(), 120.0)
    ((_, detection),) = detections_at(watch, 20.0, 120.0)
    assert detection.kind is EventKind.ALL_CLEAR


def test_driving_past_pumps_there_is_no_alarm(site):
    for seed in range(3):
        assert detections_along(alarm_watch(site, seed)[0], lane(0.5, 15.0, y=3.5)) == []


@settings(deadline=None, max_examples=examples(60))
@given(st.floats(0.0, 2.0))
def test_the_beat_is_known_whenever_it_began(shift):
    times = [0.4 * k for k in range(BEAT_RECORDINGS)]
    recordings = [(t, bool(np.any(alarm_sound(t + shift, 800, 85.0)))) for t in times]
    # A recording with very little of the tone may or may not count as one with the tone.
    assert matches_alarm_beat(recordings)


@pytest.mark.parametrize("beat", [(0.5, 1.0), (0.3, 2.0), (1.7, 2.0), (2.0, 4.0), (9.0, 9.0)])
def test_other_beats_are_not_the_alarm(beat):
    on, period = beat
    for shift in np.arange(0.0, period, 0.05):
        times = [0.4 * k for k in range(BEAT_RECORDINGS)]
        assert not matches_alarm_beat([(t, (t + shift) % period < on) for t in times])


def stands_out(samples) -> bool:
    tone, needed = tone_and_needed_power(samples)
    return tone > needed


@settings(deadline=None, max_examples=examples(40))
@given(st.floats(300.0, 3000.0), st.integers(0, 99))
def test_only_its_own_tone_is_heard(pitch, seed):
    time = np.arange(round(RECORDING * RATE)) / RATE
    noise = np.random.default_rng(seed).standard_normal(len(time)).astype(np.float32)
    tone = (10 * np.sin(2 * math.pi * pitch * time)).astype(np.float32)
    assert not stands_out(noise)
    if abs(pitch - ALARM_TONE) > 100:
        assert not stands_out(noise + tone)
    elif abs(pitch - ALARM_TONE) < 5:
        assert stands_out(noise + tone)
