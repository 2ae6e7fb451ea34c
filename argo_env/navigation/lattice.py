"""The state lattice: (cell, heading) states that the robot can stand in, and moves between them.

It contains the rules of the robot: its whole footprint stays on the surface, it turns in place on
the flat only, and on stairs its front is never the higher end, so it climbs backwards and descends
forwards.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.stages import stage
from argo_env.files.parts import Arrays
from argo_env.navigation.graphs import (
    Graph,
    label_strong_components,
    make_graph,
    make_graph_of_moves,
    subgraph,
)
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import (
    HEADINGS,
    Stencil,
    footprint_stencil,
    heading_angle,
    stencil_of_turn_to_next,
)
from argo_env.navigation.surface import Surface
from argo_env.robot.spec import MotionKind, RobotSpec, motion_kind

MARGIN = 0.02  # m that must be free around the footprint
PREFERRED_CLEARANCE = 0.1  # m around the footprint where driving is preferred
CRAMPED_FACTOR = 1.2  # cost of a second with less clearance
LEVEL = 0.1  # m of height between front and rear, or left and right, that still counts as flat
DRIVING_LEVEL = 0.05  # m of height over which a drive still counts as level
TURNING_LEVEL = 0.025  # m of height within a turn's swept area: belts scrape along a higher rim


@dataclass(frozen=True)
class Lattice:
    """The states and the moves between them.

    State s is on cell `cell[s]` with heading `heading[s]`; `rise[s]` is the height of its front
    above its rear in m. `costs` is the sparse matrix of moves from state to state: the seconds they
    take, and a little more where the robot has little clearance, so that paths keep to the middle.
    `roomy[s]` is True if there is clearance around state s. `state_of[cell, heading]` is the number
    of a state, -1 where the robot can't stand.
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

    def move_times(
        self, costs: NDArray[np.float64], source: NDArray[np.int64], target: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return the seconds that moves take: `costs` (s) without the extra for tight spots."""
        return costs / _cost_factor(self.roomy, source, target)

    def state_poses(self, states: NDArray[np.int64] | slice = slice(None)) -> NDArray[np.float64]:
        """Return x, y, z (m) and yaw (rad) of the states, shape (n, 4)."""
        cell = self.cell[states]
        x, y = self.surface.grid.centers(self.surface.i[cell], self.surface.j[cell])
        yaw = self.heading[states] * heading_angle(1)
        return np.column_stack([x, y, self.surface.z[cell], yaw])


def lattice_arrays(lattice: Lattice) -> Arrays:
    """Return a lattice as named arrays, for the disk cache; its surface and robot are left out."""
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


def lattice_from_arrays(surface: Surface, robot: RobotSpec, arrays: Arrays) -> Lattice:
    """Return the lattice that `lattice_arrays` made the arrays from."""
    return Lattice(
        surface,
        robot,
        arrays["cell"],
        arrays["heading"],
        arrays["rise"],
        arrays["roomy"],
        arrays["state_of"],
        make_graph(arrays["costs"], arrays["targets"], arrays["starts"]),
    )


@stage("finding where the robot can stand and turn")
def build_lattice(surface: Surface, robot: RobotSpec) -> Lattice:
    """Return the lattice of all states in which the robot stands safely, with all moves."""
    rises, rooms = [], []
    for heading in range(HEADINGS):
        stencil = footprint_stencil(robot.footprint, heading, MARGIN)
        z = stencil.surface_heights(surface, np.arange(surface.size))
        rises.append(rise_front_over_rear(z, stencil, heading))
        wide = footprint_stencil(robot.footprint, heading, PREFERRED_CLEARANCE)
        rooms.append(
            np.isfinite(wide.surface_heights(surface, np.arange(surface.size)).sum(axis=0))
        )
    rise, roomy = np.stack(rises, axis=1), np.stack(rooms, axis=1)
    valid = rise <= LEVEL  # False for nan, where the robot can't stand
    state_of = np.where(valid, np.cumsum(valid.ravel()).reshape(valid.shape) - 1, -1)
    cell, heading_of = np.nonzero(valid)
    rise, roomy = rise[valid], roomy[valid]
    edges = [
        *_drives(surface, robot, state_of, rise, cell, heading_of),
        *_turns(surface, robot, state_of),
    ]
    source, target, seconds = (np.concatenate(parts) for parts in zip(*edges, strict=True))
    costs = seconds * _cost_factor(roomy, source, target)
    matrix = make_graph_of_moves(costs, source, target, len(cell))
    return Lattice(surface, robot, cell, heading_of, rise, roomy, state_of, matrix)


def _cost_factor(
    roomy: NDArray[np.bool_], source: NDArray[np.int64], target: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return for each move the cost of a second: 1, or CRAMPED_FACTOR with little clearance."""
    return np.where(roomy[source] & roomy[target], 1.0, CRAMPED_FACTOR)


def connected_sublattice(lattice: Lattice, state: int) -> Lattice:
    """Return the lattice of the states that can be reached from `state` and can reach it.

    They are renumbered, in their order.
    """
    label = label_strong_components(lattice.costs)
    members = label == label[state]
    number = np.cumsum(members) - 1
    state_of = np.where(
        (lattice.state_of >= 0) & members[lattice.state_of], number[lattice.state_of], -1
    )
    return Lattice(
        lattice.surface,
        lattice.robot,
        lattice.cell[members],
        lattice.heading[members],
        lattice.rise[members],
        lattice.roomy[members],
        state_of,
        subgraph(lattice.costs, members),
    )


def rise_front_over_rear(
    z: NDArray[np.float64], stencil: Stencil, heading: int
) -> NDArray[np.float64]:
    """Return the height (m) of the front above the rear for each cell, or nan.

    It is nan where the robot can't stand: the ground does not fill the stencil, or one side is more
    than LEVEL higher than the other. Nor can it stand where the result is more than LEVEL, but the
    function leaves this to the caller.

    Args:
        z: Heights (m) of the cells of the stencil, shape (offsets, cells).
        stencil: Stencil of the footprint.
        heading: Lattice heading of the robot.
    """
    yaw = heading_angle(heading)
    offsets = np.array(stencil.offsets)
    along = offsets @ np.array([np.cos(yaw), np.sin(yaw)])
    left = offsets @ np.array([-np.sin(yaw), np.cos(yaw)])
    middle, across = np.abs(left) < 1.0, np.abs(along) < 1.0
    front = z[middle & (along > along.max() - 1.5)].mean(axis=0)
    rear = z[middle & (along < along.min() + 1.5)].mean(axis=0)
    left_side = z[across & (left > left.max() - 1.5)].mean(axis=0)
    right_side = z[across & (left < left.min() + 1.5)].mean(axis=0)
    # A sum is nan if any of its terms is, so the whole stencil must have ground.
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
    """Return the drives from each state to the next cell, one group forwards and one backwards.

    The heading stays. `Edges` are the states moves start from, those they lead to, and seconds.
    """
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
    """Return the time (s) of a turn by one heading.

    Turns and drives alternate on a path, so a turn includes the time lost when the robot sets off
    for it and for the drive after it. Most turns are by two headings, so half of it counts for
    each.
    """
    paces = robot.calibration
    return (
        heading_angle(1) / robot.real_speed(MotionKind.TURN)
        + (paces.turn.lost + paces.ahead.lost) / 2
    )


def _turns(surface: Surface, robot: RobotSpec, state_of: NDArray[np.int64]) -> list[Edges]:
    """Return the turns in place by one heading, both ways, where the swept area is free and flat.

    The results are as those of `_drives`.
    """
    edges = []
    seconds = _turn_seconds(robot)
    for heading in range(HEADINGS):
        here, there = state_of[:, heading], state_of[:, (heading + 1) % HEADINGS]
        middle = np.flatnonzero((here >= 0) & (there >= 0))
        z = stencil_of_turn_to_next(robot.footprint, heading, MARGIN).surface_heights(
            surface, middle
        )
        ok = middle[z.max(axis=0) - z.min(axis=0) <= TURNING_LEVEL]  # False where a height is nan
        time = np.full(len(ok), seconds)
        edges += [(here[ok], there[ok], time), (there[ok], here[ok], time)]
    return edges
