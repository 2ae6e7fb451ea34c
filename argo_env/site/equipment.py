"""Process equipment, columns and docking stations as solids."""

import math
from itertools import pairwise

from argo_env.site.shapes import Box, Cylinder, Element, Role, Solid, Vector
from argo_env.site.spec import AreaSpec, CheckpointSpec, PipeSpec, PumpSpec, VesselSpec

DOCK_DISTANCE = 0.62  # m from the centre of a docked robot to the face of its station
MOUNT_LENGTH = 0.2  # m from the face of a checkpoint back to what carries it


def build_vessel(vessel: VesselSpec, z: float) -> Element:
    """A vessel with its centre `center` above height `z`; a lying one stands on two saddles."""
    x, y, height = vessel.center
    turn: Vector = {
        "x": (0.0, math.pi / 2, 0.0),
        "y": (math.pi / 2, 0.0, 0.0),
        "z": (0.0, 0.0, 0.0),
    }[vessel.axis]
    shell = Cylinder((x, y, z + height), vessel.radius, vessel.length, turn)
    if vessel.axis == "z":
        return Element(vessel.name, Role.VESSEL, (shell,), "vessel")
    along = (1.0, 0.0) if vessel.axis == "x" else (0.0, 1.0)
    saddles = tuple(
        Box(
            (x + s * along[0], y + s * along[1], z + height / 2 - vessel.radius / 4),
            (
                0.2 if along[0] else 1.4 * vessel.radius,
                0.2 if along[1] else 1.4 * vessel.radius,
                height - vessel.radius / 2,
            ),
        )
        for s in (-0.3 * vessel.length, 0.3 * vessel.length)
    )
    return Element(vessel.name, Role.VESSEL, (shell, *saddles), "vessel")


def build_pipe(pipe: PipeSpec) -> Element:
    """A pipe as a cylinder from each point to the next."""
    solids = []
    for (x0, y0, z0), (x1, y1, z1) in pairwise(pipe.points):
        dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        turn = (0.0, math.acos(dz / length), math.atan2(dy, dx))
        center = ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
        # Reaching half a bore beyond the points closes the corners.
        solids.append(Cylinder(center, pipe.radius, length + pipe.radius, turn))
    return Element(pipe.name, Role.PIPE, tuple(solids), "pipe")


def build_pump(pump: PumpSpec, z: float) -> Element:
    """A centrifugal pump and its motor on a skid of 1.2 m by 0.6 m."""
    yaw = math.radians(pump.yaw)
    cos, sin = math.cos(yaw), math.sin(yaw)

    def at(along: float, up: float) -> Vector:
        return pump.center[0] + along * cos, pump.center[1] + along * sin, z + up

    lying = (0.0, math.pi / 2, yaw)
    solids: tuple[Solid, ...] = (
        Box(at(0.0, 0.08), (1.2, 0.6, 0.16), (0.0, 0.0, yaw)),
        Cylinder(at(-0.2, 0.42), 0.22, 0.62, lying),
        Cylinder(at(0.32, 0.42), 0.06, 0.5, lying),
        Cylinder(at(0.42, 0.44), 0.27, 0.18, lying),
        Cylinder(at(0.42, 0.75), 0.07, 0.4),
    )
    return Element(pump.name, Role.PUMP, solids, "pump")


def build_column(number: int, center: tuple[float, float], bottom: float, top: float) -> Element:
    """A steel column of 0.2 m by 0.2 m."""
    box = Box((center[0], center[1], (bottom + top) / 2), (0.2, 0.2, top - bottom))
    return Element(f"column {number}", Role.STRUCTURE, (box,), "structure")


def build_dock(area: AreaSpec, ground_z: float) -> Element:
    """A docking station: a cabinet whose charging contacts face the docked robot, and a sign."""
    x, y, degrees = area.dock
    yaw = math.radians(degrees)

    def at(along: float, up: float) -> Vector:
        return x + along * math.cos(yaw), y + along * math.sin(yaw), ground_z + up

    turn = (0.0, 0.0, yaw)
    solids: tuple[Solid, ...] = (
        Box(at(DOCK_DISTANCE + 0.2, 0.35), (0.4, 0.7, 0.7), turn),
        Box(at(DOCK_DISTANCE + 0.3, 0.9), (0.08, 0.08, 0.4), turn),
        Box(at(DOCK_DISTANCE + 0.2, 1.2), (0.1, 0.5, 0.3), turn),
    )
    return Element(f"docking station {area.number}", Role.DOCK, solids, "dock")


def build_mount(checkpoint: CheckpointSpec, floor_z: float) -> Element:
    """The bracket between a checkpoint and the pipe or vessel behind it."""
    x, y, height = checkpoint.position
    yaw = math.radians(checkpoint.yaw)
    back = (MOUNT_LENGTH + 0.06) / 2
    center = (x - back * math.cos(yaw), y - back * math.sin(yaw), floor_z + height)
    box = Box(center, (MOUNT_LENGTH - 0.06, 0.04, 0.04), (0.0, 0.0, yaw))
    return Element(f"mount of {checkpoint.name}", Role.STRUCTURE, (box,), "structure")
