"""Where the robot can be and how it can move: a graph of (cell, heading) states.

The rules of the robot are in here: its whole footprint stays on the surface, it turns in place on
the flat only, and on stairs its front is never the higher end, so it climbs backwards and descends
forwards.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.stages import stage
from argo_env.files.parts import Arrays
from argo_env.navigation.graphs import Graph, graph_of, graph_of_moves, part_of, strong_parts
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, Stencil, heading_angle, standing, turning
from argo_env.navigation.surface import Surface
from argo_env.robot.spec import MotionKind, RobotSpec, motion_kind

MARGIN = 0.02  # m kept free around the footprint
ROOM = 0.1  # m around the footprint where driving is preferred
CRAMPED_FACTOR = 1.2  # what a second with less room counts
LEVEL = 0.1  # m of height between front and rear, or left and right, that still counts as flat
DRIVING_LEVEL = 0.05  # m of height that a level drive goes over
TURNING_LEVEL = 0.025  # m of height within the circle of a turn: belts scrape along a higher rim


@dataclass(frozen=True)
class Lattice:
    """The states and the moves between them. State s stands on cell `cell[s]`, heading
    `heading[s]`; `rise[s]` is the height of its front above its rear in m.

    `costs` is the sparse matrix of moves from state to state: the seconds they take, and a little
    more where the robot has little room, so that paths keep to the middle. `roomy[s]` says whether
    there is room around state s. `state_of[cell, heading]` finds a state, -1 where the robot can't
    stand.
    """

    surface: Surface
    robot: RobotSpec
    cell: NDArray[np.int64]
    heading: NDArray[np.int64]
    rise: NDArray[np.float64]
    roomy: NDArray[np.bool_]
    state_of: NDArray[np.int64]
    costs: Graph

    @property
    def size(self) -> int:
        return len(self.cell)

    def seconds(
        self, costs: NDArray[np.float64], source: NDArray[np.int64], target: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """The seconds that moves of the given `costs` from `source` to `target` take."""
        return costs / _factor(self.roomy, source, target)

    def poses(self, states: NDArray[np.int64] | slice = slice(None)) -> NDArray[np.float64]:
        """x, y, z (m) and yaw (rad) of the states, shape (n, 4)."""
        cell = self.cell[states]
        x, y = self.surface.grid.centers(self.surface.i[cell], self.surface.j[cell])
        yaw = self.heading[states] * heading_angle(1)
        return np.column_stack([x, y, self.surface.z[cell], yaw])


def lattice_arrays(lattice: Lattice) -> Arrays:
    """A lattice as arrays, its surface and robot apart."""
    return {
        "cell": lattice.cell,
        "heading": lattice.heading,
        "rise": lattice.rise,
        "roomy": lattice.roomy,
        "state_of": lattice.state_of,
        "costs": lattice.costs.data,
        "targets": lattice.costs.indices,
        "starts": lattice.costs.indptr,
    }


def lattice_of(surface: Surface, robot: RobotSpec, arrays: Arrays) -> Lattice:
    """The lattice that `lattice_arrays` was given."""
    return Lattice(
        surface,
        robot,
        arrays["cell"],
        arrays["heading"],
        arrays["rise"],
        arrays["roomy"],
        arrays["state_of"],
        graph_of(arrays["costs"], arrays["targets"], arrays["starts"]),
    )


@stage("finding where the robot can stand and turn")
def build_lattice(surface: Surface, robot: RobotSpec) -> Lattice:
    """All states in which the robot stands safely, and all moves between them."""
    rises, rooms = [], []
    for heading in range(HEADINGS):
        stencil = standing(robot.footprint, heading, MARGIN)
        z = stencil.heights(surface, np.arange(surface.size))
        rises.append(standing_rise(z, stencil, heading))
        wide = standing(robot.footprint, heading, ROOM)
        rooms.append(np.isfinite(wide.heights(surface, np.arange(surface.size)).sum(axis=0)))
    rise, roomy = np.stack(rises, axis=1), np.stack(rooms, axis=1)
    valid = rise <= LEVEL  # nan, where the robot can't stand, is not
    state_of = np.where(valid, np.cumsum(valid.ravel()).reshape(valid.shape) - 1, -1)
    cell, heading_of = np.nonzero(valid)
    rise, roomy = rise[valid], roomy[valid]
    edges = [
        *_drives(surface, robot, state_of, rise, cell, heading_of),
        *_turns(surface, robot, state_of),
    ]
    source, target, seconds = (np.concatenate(parts) for parts in zip(*edges, strict=True))
    costs = seconds * _factor(roomy, source, target)
    matrix = graph_of_moves(costs, source, target, len(cell))
    return Lattice(surface, robot, cell, heading_of, rise, roomy, state_of, matrix)


def _factor(
    roomy: NDArray[np.bool_], source: NDArray[np.int64], target: NDArray[np.int64]
) -> NDArray[np.float64]:
    """What a second of each move counts."""
    return np.where(roomy[source] & roomy[target], 1.0, CRAMPED_FACTOR)


def connected_part(lattice: Lattice, state: int) -> Lattice:
    """The lattice of the states that can be reached from `state` and from which it is reached."""
    label = strong_parts(lattice.costs)
    kept = label == label[state]
    number = np.cumsum(kept) - 1
    state_of = np.where(
        (lattice.state_of >= 0) & kept[lattice.state_of], number[lattice.state_of], -1
    )
    return Lattice(
        lattice.surface,
        lattice.robot,
        lattice.cell[kept],
        lattice.heading[kept],
        lattice.rise[kept],
        lattice.roomy[kept],
        state_of,
        part_of(lattice.costs, kept),
    )


def standing_rise(z: NDArray[np.float64], stencil: Stencil, heading: int) -> NDArray[np.float64]:
    """Height of the front above the rear for every cell, by the heights `z` (m) of its `stencil`;
    nan where the robot can't stand: there is no ground all over the stencil, or one side is too
    high. Where it is more than LEVEL it can't either."""
    yaw = heading_angle(heading)
    offsets = np.array(stencil.offsets)
    along = offsets @ np.array([np.cos(yaw), np.sin(yaw)])
    left = offsets @ np.array([-np.sin(yaw), np.cos(yaw)])
    middle, across = np.abs(left) < 1.0, np.abs(along) < 1.0
    front = z[middle & (along > along.max() - 1.5)].mean(axis=0)
    rear = z[middle & (along < along.min() + 1.5)].mean(axis=0)
    left_side = z[across & (left > left.max() - 1.5)].mean(axis=0)
    right_side = z[across & (left < left.min() + 1.5)].mean(axis=0)
    # A sum is nan if any of its terms is, so this asks for the whole stencil.
    stands = np.isfinite(z.sum(axis=0)) & (np.abs(left_side - right_side) <= LEVEL)
    return np.where(stands, front - rear, np.nan)


Edges = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]


def _drives(
    surface: Surface,
    robot: RobotSpec,
    state_of: NDArray[np.int64],
    rise: NDArray[np.float64],
    cell: NDArray[np.int64],
    heading: NDArray[np.int64],
) -> list[Edges]:
    """Moves to the next cell, forwards along the heading and backwards against it."""
    edges = []
    length = robot.footprint.front + robot.footprint.rear
    for gear in (1, -1):
        direction = heading if gear > 0 else (heading + HEADINGS // 2) % HEADINGS
        neighbour = surface.links[cell, direction]
        target = np.where(neighbour >= 0, state_of[neighbour, heading], -1)
        ok = target >= 0
        source, target = np.flatnonzero(ok), target[ok]
        mean_rise = (rise[source] + rise[target]) / 2
        step = np.where(heading[source] % 2 == 0, CELL, CELL * np.sqrt(2.0))
        flat, stairs = (robot.real_speed(motion_kind(gear, tilted)) for tilted in (False, True))
        speed = np.where(np.abs(mean_rise) > LEVEL, stairs, flat)
        edges.append((source, target, step * np.hypot(1.0, mean_rise / length) / speed))
    return edges


def _turn_seconds(robot: RobotSpec) -> float:
    """s for a turn by one heading.

    A way is turns and drives by turns, so with every turn the time is lost that setting off for it
    and for the drive after it takes. Most are by two headings.
    """
    paces = robot.calibration
    return (
        heading_angle(1) / robot.real_speed(MotionKind.TURN)
        + (paces.turn.lost + paces.ahead.lost) / 2
    )


def _turns(surface: Surface, robot: RobotSpec, state_of: NDArray[np.int64]) -> list[Edges]:
    """Turns in place by one heading, both ways, where the swept circle is free and flat."""
    edges = []
    seconds = _turn_seconds(robot)
    for heading in range(HEADINGS):
        here, there = state_of[:, heading], state_of[:, (heading + 1) % HEADINGS]
        middle = np.flatnonzero((here >= 0) & (there >= 0))
        z = turning(robot.footprint, heading, MARGIN).heights(surface, middle)
        ok = middle[z.max(axis=0) - z.min(axis=0) <= TURNING_LEVEL]  # false where one is nan
        time = np.full(len(ok), seconds)
        edges += [(here[ok], there[ok], time), (there[ok], here[ok], time)]
    return edges
