"""As what faults show: which findings of a run may be of which fault."""

import math
from collections.abc import Callable, Mapping
from typing import cast

import numpy as np

from argo_compiler.il import EventKind
from argo_env.faults.checkpoints import AbnormalValue
from argo_env.faults.kinds import AnyFault
from argo_env.faults.plant import AbnormalPump, GasLeakFault, HotSpotFault
from argo_env.faults.walkway import MissingPlate
from argo_env.run.record import FROM_READING, Anomaly, Reading, RunRecord
from argo_env.sensing.signals.microphone import pump_places
from argo_env.site import Site
from argo_env.site.shapes import half_extents

_GAS_REACHES = 25.0  # m
_SPOT_OFF = 2.5  # m that the place of a hot spot is wrong at most
_BESIDE = 0.5  # m beside an obstacle, or the edge of a hole, that may be taken for it
_NOTICED = 1.0  # s after its end in which anything may still be noticed
_OUTLASTS = {"gas_leak": 120.0, "drive_dysfunction": 11.0}
"""By the kind of a fault: s after its end in which it may still be found, as gas has to disperse,
and the way made is compared with the way planned over 10 s."""

_SIGNS: dict[str, tuple[EventKind, str]] = {
    "abnormal_value": (EventKind.ABNORMAL_READING, FROM_READING),
    "gas_leak": (EventKind.GAS_LEAK, "gas"),
    "hot_spot": (EventKind.HOT_SPOT, "heat"),
    "abnormal_pump": (EventKind.ABNORMAL_SOUND, "pumps"),
    "platform_alarm": (EventKind.PLATFORM_ALARM, "alarm"),
    "brick": (EventKind.POSITIVE_OBSTACLE, "terrain"),
    "blocked_stairs": (EventKind.POSITIVE_OBSTACLE, "terrain"),
    "missing_plate": (EventKind.NEGATIVE_OBSTACLE, "terrain"),
    "low_battery": (EventKind.LOW_BATTERY, "battery"),
    "worn_battery": (EventKind.LOW_BATTERY, "battery"),
    "connection_loss": (EventKind.CONNECTION_LOST, "connection"),
    "emergency_stop": (EventKind.EMERGENCY_STOP, "emergency stop"),
    "sensor_dysfunction": (EventKind.DYSFUNCTION, "camera"),
    "drive_dysfunction": (EventKind.DYSFUNCTION, "drive"),
}
"""By the kind of a fault: as what it is found, and by which watch. A checkpoint that was moved is
found by nothing: it is read all the same."""


def can_be_found(fault: AnyFault) -> bool:
    """Whether there is anything that such a fault is found by."""
    return fault.kind in _SIGNS


def may_be_of(anomaly: Anomaly, fault: AnyFault, record: RunRecord, site: Site) -> bool:
    """Whether what the robot found in a run on the site may be this fault of the run: of its kind,
    while it lasted, and where it is, as far as the finding tells a place."""
    if not can_be_found(fault) or not _lasts(fault, anomaly.t):
        return False
    if (anomaly.kind, anomaly.source) != _SIGNS[fault.kind]:
        return False
    if isinstance(fault, AbnormalValue):
        reading = reading_of(anomaly, record)
        return reading is not None and reading.checkpoint == fault.checkpoint
    is_there = _PLACED.get(fault.kind)
    return is_there is None or is_there(anomaly, fault, site)


def _lasts(fault: AnyFault, t: float) -> bool:
    if fault.ends is None:
        return t >= fault.begins
    return fault.begins <= t <= fault.ends + _OUTLASTS.get(fault.kind, _NOTICED)


def reading_of(anomaly: Anomaly, record: RunRecord) -> Reading | None:
    """The reading that an abnormal value was found by; None for what was found otherwise."""
    if not anomaly.is_reading:
        return None
    return next((reading for reading in record.readings if reading.t == anomaly.t), None)


def _smells_there(anomaly: Anomaly, fault: AnyFault, _: Site) -> bool:
    place, at = cast("GasLeakFault", fault).place, anomaly.noticed_from
    return place is not None and at is not None and math.dist(place, at) <= _GAS_REACHES


def _glows_there(anomaly: Anomaly, fault: AnyFault, _: Site) -> bool:
    place, at = cast("HotSpotFault", fault).place, anomaly.place
    return place is not None and at is not None and math.dist(place, at) <= _SPOT_OFF


def _is_that_pump(anomaly: Anomaly, fault: AnyFault, site: Site) -> bool:
    if anomaly.place is None:
        return False
    places, at = pump_places(site), anomaly.place
    nearest = min(places, key=lambda name: math.dist(places[name], at))
    return nearest == cast("AbnormalPump", fault).pump


def _stands_there(anomaly: Anomaly, fault: AnyFault, site: Site) -> bool:
    """Whether the place is inside the boxes about what the fault adds to the site, or just beside
    one."""
    if anomaly.place is None:
        return False
    place, planned = np.array(anomaly.place), {element.name for element in site.elements}
    return any(
        bool(np.all(np.abs(place - solid.center) <= half_extents(solid) + _BESIDE))
        for element in fault.changed(site)
        if element.name not in planned
        for solid in element.solids
    )


def _is_missing_there(anomaly: Anomaly, fault: AnyFault, site: Site) -> bool:
    plate = cast("MissingPlate", fault)
    if anomaly.place is None or plate.rect is None:
        return False
    (x, y, z), (x0, y0, x1, y1) = anomaly.place, plate.rect
    beside = x0 - _BESIDE <= x <= x1 + _BESIDE and y0 - _BESIDE <= y <= y1 + _BESIDE
    return beside and site.floor_at(z) == plate.floor


_PLACED: Mapping[str, Callable[[Anomaly, AnyFault, Site], bool]] = {
    "gas_leak": _smells_there,
    "hot_spot": _glows_there,
    "abnormal_pump": _is_that_pump,
    "brick": _stands_there,
    "blocked_stairs": _stands_there,
    "missing_plate": _is_missing_there,
}
"""By the kind of a fault that has a place: whether what was found is there."""
