"""Closed parts of the surface, such as what the robot found in its path."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Pose
from argo_env.navigation.graphs import make_graph
from argo_env.navigation.lattice import MARGIN, Lattice
from argo_env.navigation.path import Path
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, SWEEP_STEPS, heading_angle, touches_rectangles
from argo_env.navigation.surface import Surface
from argo_env.robot.spec import RobotSpec
from argo_env.site.spec import Rect

LAYER = 1.0  # m above and below a blockage where the surface is closed; storeys are higher

_TURN_STEP = 0.05  # rad between the headings of a turn that are checked


@dataclass(frozen=True)
class Blockage:
    """Rectangle of the surface that no part of the robot may be over.

    `rect` is [x0, y0, x1, y1], near the height `z`, all in m; `reason` is a text for people.
    """

    rect: Rect
    z: float
    reason: str


def closed_cells(surface: Surface, blockages: Sequence[Blockage]) -> NDArray[np.bool_]:
    """Return a mask of the surface's cells that a blockage touches, even if only at their edges."""
    positions = surface.cell_positions()
    closed = np.zeros(surface.size, dtype=bool)
    for blockage in blockages:
        closed |= _within(positions, blockage, CELL / 2 + 1e-9)
    return closed


def _within(positions: NDArray[np.float64], blockage: Blockage, reach: float) -> NDArray[np.bool_]:
    """Return a mask of the positions in or near a blockage, shape (n,).

    Args:
        positions: Points in m, shape (n, 3).
        blockage: Blockage, whose layer a point must be in.
        reach: Distance (m) that a point may be outside the rectangle along each axis.
    """
    (x0, y0, x1, y1), (x, y, z) = blockage.rect, positions.T
    return np.asarray(
        (np.abs(z - blockage.z) <= LAYER)
        & (x >= x0 - reach)
        & (x <= x1 + reach)
        & (y >= y0 - reach)
        & (y <= y1 + reach)
    )


def with_states_closed(lattice: Lattice, blockages: Sequence[Blockage]) -> Lattice:
    """Return a lattice without the states and turns in which the robot touches a blockage.

    MARGIN is added around the robot, as everywhere; of a turn the whole swept area counts. All
    states keep their numbers, but the closed ones have no moves and are not in `state_of`.
    """
    closed, no_turn = np.zeros(lattice.size, dtype=bool), np.zeros(lattice.size, dtype=bool)
    positions = lattice.surface.cell_positions()
    for blockage in blockages:
        near = _states_near(lattice, positions, blockage)
        in_state, in_turn = _touched_states(lattice, positions, near, blockage)
        closed[near] |= in_state
        no_turn[near] |= in_turn
    state_of = lattice.state_of.copy()
    closed_states = np.flatnonzero(closed)
    state_of[lattice.cell[closed_states], lattice.heading[closed_states]] = -1
    moves = lattice.costs.tocoo()
    source, target = moves.coords
    before = np.where(
        (lattice.heading[source] + 1) % HEADINGS == lattice.heading[target], source, target
    )
    turns = lattice.cell[source] == lattice.cell[target]
    remaining = ~(closed[source] | closed[target] | (turns & no_turn[before]))
    lost = np.bincount(source[~remaining], minlength=lattice.size)
    start = lattice.costs.indptr - np.concatenate([[0], np.cumsum(lost)])
    costs = make_graph(lattice.costs.data[remaining], lattice.costs.indices[remaining], start)
    return replace(lattice, state_of=state_of, costs=costs)


def _states_near(
    lattice: Lattice, positions: NDArray[np.float64], blockage: Blockage
) -> NDArray[np.int64]:
    """Return the numbers of the lattice's states that may touch the blockage, in ascending order.

    The heading is ignored: the footprint's radius and MARGIN decide. `positions` are the centres of
    the surface's cells in m, shape (n, 3).
    """
    cells = _within(positions, blockage, lattice.robot.footprint.radius + MARGIN)
    states = lattice.state_of[cells]
    return np.sort(states[states >= 0])


def _touched_states(
    lattice: Lattice,
    positions: NDArray[np.float64],
    states: NDArray[np.int64],
    blockage: Blockage,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return masks of the states, and of the turns from them, that touch the blockage.

    The turns lead to the next heading, counter-clockwise.
    """
    x0, y0, x1, y1 = blockage.rect
    centers = positions[lattice.cell[states]]
    to_x, to_y = (x0 + x1) / 2 - centers[:, 0], (y0 + y1) / 2 - centers[:, 1]
    half = ((x1 - x0) / 2 + 1e-9, (y1 - y0) / 2 + 1e-9)
    yaw = lattice.heading[states].astype(np.float64) * heading_angle(1)
    swept = [
        touches_rectangles(
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


def turn_touches_blockage(
    start: Pose, turn: float, blockages: Sequence[Blockage], robot: RobotSpec
) -> bool:
    """Return True if a turn in place touches a blockage that the robot does not touch at the start.

    The robot turns by `turn` (rad) from `start`, without a margin.
    """
    yaw = start.yaw + turn * np.linspace(0.0, 1.0, 2 + int(abs(turn) / _TURN_STEP))
    for blockage in blockages:
        if abs(start.z - blockage.z) > LAYER:
            continue
        x0, y0, x1, y1 = blockage.rect
        x = np.full(len(yaw), (x0 + x1) / 2 - start.x)
        y = np.full(len(yaw), (y0 + y1) / 2 - start.y)
        half = (x1 - x0) / 2, (y1 - y0) / 2
        touched = touches_rectangles(robot.footprint, 0.0, yaw, x, y, half)
        if touched.any() and not touched[0]:
            return True
    return False


def may_touch_blockage(path: Path, blockages: Sequence[Blockage], robot: RobotSpec) -> bool:
    """Return True if the path leads so near to a blockage that the robot might touch it.

    The heading is ignored: the robot counts as a disc with the footprint's radius plus MARGIN.
    """
    points = np.array(
        [
            (pose.x, pose.y, pose.z)
            for motion in path.motions
            for pose in map(
                motion.pose_at, np.linspace(0.0, 1.0, 2 + int(motion.length / CELL)).tolist()
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
