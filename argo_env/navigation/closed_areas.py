"""Parts of the surface that are closed, such as what the robot found in its way."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_env.navigation.graphs import graph_of
from argo_env.navigation.lattice import MARGIN, Lattice
from argo_env.navigation.path import Path
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, SWEEP_STEPS, heading_angle, touches
from argo_env.navigation.surface import Surface
from argo_env.robot.spec import RobotSpec
from argo_env.site.spec import Rect

LAYER = 1.0  # m above and below a blockage in which the surface is closed; storeys are higher

_TURN_STEP = 0.05  # rad between the headings of a turn that are looked at


@dataclass(frozen=True)
class Blockage:
    """A rectangle [x0, y0, x1, y1] of the surface near the height `z`, all in m, that no part of
    the robot may be over; `reason` says to people why."""

    rect: Rect
    z: float
    reason: str


def closed_cells(surface: Surface, blockages: Sequence[Blockage]) -> NDArray[np.bool_]:
    """Which cells of the surface a blockage touches, even at their edges."""
    places = surface.positions()
    closed = np.zeros(surface.size, dtype=bool)
    for blockage in blockages:
        closed |= _within(places, blockage, CELL / 2 + 1e-9)
    return closed


def _within(places: NDArray[np.float64], blockage: Blockage, reach: float) -> NDArray[np.bool_]:
    """Return for each place, shape (n, 3), whether it is in the blockage's layer and within `reach`
    (m) of it along each axis."""
    (x0, y0, x1, y1), (x, y, z) = blockage.rect, places.T
    return np.asarray(
        (np.abs(z - blockage.z) <= LAYER)
        & (x >= x0 - reach)
        & (x <= x1 + reach)
        & (y >= y0 - reach)
        & (y <= y1 + reach)
    )


def close(lattice: Lattice, blockages: Sequence[Blockage]) -> Lattice:
    """The lattice without the states whose footprint, and the turns whose swept area, touches a
    blockage, MARGIN added around the robot as everywhere.

    The closed states keep their numbers, but have no moves and are not found in `state_of`.
    """
    shut, stuck = np.zeros(lattice.size, dtype=bool), np.zeros(lattice.size, dtype=bool)
    places = lattice.surface.positions()
    for blockage in blockages:
        near = _near(lattice, places, blockage)
        standing, turning = _touched(lattice, places, near, blockage)
        shut[near] |= standing
        stuck[near] |= turning
    state_of = lattice.state_of.copy()
    gone = np.flatnonzero(shut)
    state_of[lattice.cell[gone], lattice.heading[gone]] = -1
    moves = lattice.costs.tocoo()
    source, target = moves.coords
    before = np.where(
        (lattice.heading[source] + 1) % HEADINGS == lattice.heading[target], source, target
    )
    turns = lattice.cell[source] == lattice.cell[target]
    kept = ~(shut[source] | shut[target] | (turns & stuck[before]))
    lost = np.bincount(source[~kept], minlength=lattice.size)
    start = lattice.costs.indptr - np.concatenate([[0], np.cumsum(lost)])
    costs = graph_of(lattice.costs.data[kept], lattice.costs.indices[kept], start)
    return replace(lattice, state_of=state_of, costs=costs)


def _near(lattice: Lattice, places: NDArray[np.float64], blockage: Blockage) -> NDArray[np.int64]:
    """The states that may touch the blockage; `places` are those of the cells."""
    cells = _within(places, blockage, lattice.robot.footprint.radius + MARGIN)
    states = lattice.state_of[cells]
    return np.sort(states[states >= 0])


def _touched(
    lattice: Lattice,
    places: NDArray[np.float64],
    states: NDArray[np.int64],
    blockage: Blockage,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether the robot touches the blockage in each of the states, and while it turns from it to
    the next heading, counter-clockwise."""
    x0, y0, x1, y1 = blockage.rect
    place = places[lattice.cell[states]]
    to_x, to_y = (x0 + x1) / 2 - place[:, 0], (y0 + y1) / 2 - place[:, 1]
    half = ((x1 - x0) / 2 + 1e-9, (y1 - y0) / 2 + 1e-9)
    yaw = lattice.heading[states].astype(np.float64) * heading_angle(1)
    swept = [
        touches(
            lattice.robot.footprint,
            MARGIN,
            yaw + k / SWEEP_STEPS * heading_angle(1),
            to_x,
            to_y,
            half,
        )
        for k in range(SWEEP_STEPS + 1)
    ]
    return swept[0], np.any(swept, axis=0)


def turns_over(start: Pose, turn: float, blockages: Sequence[Blockage], robot: RobotSpec) -> bool:
    """Whether a robot that turns in place from `start` by `turn` (rad) touches a blockage that it
    does not touch at the start."""
    yaw = start.yaw + turn * np.linspace(0.0, 1.0, 2 + int(abs(turn) / _TURN_STEP))
    for blockage in blockages:
        if abs(start.z - blockage.z) > LAYER:
            continue
        x0, y0, x1, y1 = blockage.rect
        x = np.full(len(yaw), (x0 + x1) / 2 - start.x)
        y = np.full(len(yaw), (y0 + y1) / 2 - start.y)
        half = (x1 - x0) / 2, (y1 - y0) / 2
        touched = touches(robot.footprint, 0.0, yaw, x, y, half)
        if touched.any() and not touched[0]:
            return True
    return False


def leads_through(path: Path, blockages: Sequence[Blockage], robot: RobotSpec) -> bool:
    """Whether a robot on the path might touch a blockage, however it is turned."""
    points = np.array(
        [
            (pose.x, pose.y, pose.z)
            for motion in path.motions
            for pose in map(
                motion.at, np.linspace(0.0, 1.0, 2 + int(motion.length / CELL)).tolist()
            )
        ]
    ).reshape(-1, 3)
    reach = robot.footprint.radius + MARGIN
    for blockage in blockages:
        x0, y0, x1, y1 = blockage.rect
        x, y, z = points.T
        away = np.hypot(x - np.clip(x, x0, x1), y - np.clip(y, y0, y1))
        if ((away <= reach) & (np.abs(z - blockage.z) <= LAYER)).any():
            return True
    return False
