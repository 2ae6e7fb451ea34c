"""Traction of belts by contact-surface motion.

A belt is a smooth body that pushes on the ground along its normals only; the friction of its
surface is added as a force at every contact. The idea is that of M. Pecka, K. Zimmermann and
T. Svoboda, "Fast simulation of vehicles with non-deformable tracks" (IROS 2017), who give contacts
of a rigid track the belt's surface velocity. There the friction solver of a physics engine gets
that velocity; PyBullet's solver has no such input, so here friction is a force, as elastic and
damped grousers make it.
"""

from dataclasses import dataclass, replace
from math import sqrt
from typing import Any

Contact = tuple[Any, ...]
"""row of PyBullet's `getContactPoints`"""

Wrench = tuple[float, float, float, float, float, float]

_COLUMNS = 10  # of a contact's row, up to the force along the normal
_SMOOTH = 0.05  # share of the grip on walls and rails, so that the robot does not climb them
# Sums over contacts, weighted with force: the force itself; slip along and across the belt;
# position along the body, and its square; tangent and its moment; position.
_NO_SUMS = (0.0,) * 14
_BELTS = 4  # left and right track, left and right flipper
INNER, TRACK_TOP = 0.16, 0.355  # m: tracks lie outside of INNER and below TRACK_TOP, the hull not
_CAP = 1.5  # share of the weight, up to which contacts stiffen the belts; keeps impacts stable


@dataclass(frozen=True)
class Traction:
    """Traction of belts on the ground: grip, damping and stiffness."""

    grip: float = 2.2
    """highest force along the belt over the normal force; over 1, as grousers hook into nosings"""
    side_grip: float = 0.5
    """highest force across the belt over the normal force: rubber slides on steel or concrete"""
    damping: float = 3.9
    """s/m: share of the highest force for each m/s of slip; with the grip above, a product of more
    than 12 s/m is unstable at 240 Hz"""
    stiffness: float = 77.0
    """1/m: share of the highest force for each m that grousers are bent; holds it on slopes"""

    def with_scaled_grip(self, factor: float) -> "Traction":
        """Return the same traction with its grip, along and across, multiplied by `factor`."""
        return replace(self, grip=factor * self.grip, side_grip=factor * self.side_grip)


class Belts:
    """Forces of all belts of a robot. Holds the bending of the grousers of each belt.

    A belt, of a track or of a flipper, slips in three ways: along, across, and by twisting on the
    spot. The three share its grip, in the direction in which the belt slips. So a twisted belt
    slides sideways at the least force, as real belts do.
    """

    def __init__(
        self, center: tuple[float, float, float], traction: Traction, weight: float
    ) -> None:
        """Start with grousers that are not bent.

        `center` (m) is the body's centre of mass in its frame; `weight` (N) is the robot's.
        """
        self._center = center
        self._traction = traction
        self._cap = _CAP * weight
        self.bends = [0.0] * (3 * _BELTS)
        """bending of the grousers along, across and by twisting in m, for each belt"""

    def wrench_and_other_contacts(
        self,
        contacts: list[Contact],
        walking: int,
        speeds: tuple[float, float],
        position: tuple[float, float, float],
        axes: tuple[float, ...],
        velocity: tuple[float, float, float],
        spin: tuple[float, float, float],
        dt: float,
    ) -> tuple[Wrench, list[Contact]]:
        """Return the wrench of all belts on the body about `position`, and the other contacts.

        The wrench is the force (N) and the torque (N m) in the world's axes. The other contacts are
        all except those of belts with the walking surfaces.

        Args:
            contacts: the robot's contacts, rows of PyBullet's `getContactPoints`
            walking: the link of the terrain with the walking surfaces
            speeds: of the left and the right belts (m/s), positive when driving forwards
            position: the body's centre of mass (m)
            axes: the body's rotation matrix row by row
            velocity: of the body at `position` (m/s)
            spin: the body's angular velocity (rad/s)
            dt: the time since the last call (s)
        """
        sums, total, other_contacts = self._sum_contacts(
            contacts, walking, speeds, position, axes, velocity, spin
        )
        return self._wrench_from(sums, total, axes, spin, dt), other_contacts

    def _sum_contacts(
        self,
        contacts: list[Contact],
        walking: int,
        speeds: tuple[float, float],
        position: tuple[float, float, float],
        axes: tuple[float, ...],
        velocity: tuple[float, float, float],
        spin: tuple[float, float, float],
    ) -> tuple[list[tuple[float, ...]], float, list[Contact]]:
        """Return the sums for each belt, the total normal force (N), and the other contacts.

        The sums are those that `_NO_SUMS` lists, over the contacts of a belt. The total is that of
        all belts, summed in the order of the contacts. The arguments are as for
        `wrench_and_other_contacts`.
        """
        # Plain floats in local variables: this runs 240 times a simulated second.
        px, py, pz = position
        fx, lx, ux, fy, ly, uy, fz, lz, uz = axes
        vx, vy, vz = velocity
        wx, wy, wz = spin
        _, center_y, center_z = self._center
        left_speed, right_speed = speeds
        sums: list[tuple[float, ...]] = [_NO_SUMS] * _BELTS
        other_contacts = []
        total = 0.0
        for contact in contacts:
            _, _, _, link, other, (x, y, z), _, (nx, ny, nz), _, force = contact[:_COLUMNS]
            if force <= 0.0:
                continue
            x, y, z = x - px, y - py, z - pz
            left = x * lx + y * ly + z * lz + center_y
            if link >= 0:
                belt = 2
            elif (left > INNER or left < -INNER) and (
                x * ux + y * uy + z * uz + center_z < TRACK_TOP
            ):
                belt = 0
            else:
                other_contacts.append(contact)
                continue
            if other != walking:
                other_contacts.append(contact)
            # The belt runs along its left axis times the normal.
            tx, ty, tz = ly * nz - lz * ny, lz * nx - lx * nz, lx * ny - ly * nx
            length = sqrt(tx * tx + ty * ty + tz * tz)
            if length < 0.01:
                continue  # a flank, along which the belt does not run
            # From here on the tangent is the force times the unit vector.
            if other != walking:
                force *= _SMOOTH
            tx, ty, tz = force * tx, force * ty, force * tz
            force *= length
            if left < 0.0:
                belt += 1
                speed = right_speed
            else:
                speed = left_speed
            sx, sy, sz = vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x
            ahead = x * fx + y * fy + z * fz
            s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13 = sums[belt]
            sums[belt] = (
                s0 + force,
                s1 + (sx * tx + sy * ty + sz * tz - force * speed),
                s2 + force * (sx * lx + sy * ly + sz * lz),
                s3 + force * ahead,
                s4 + force * ahead * ahead,
                s5 + tx,
                s6 + ty,
                s7 + tz,
                s8 + (y * tz - z * ty),
                s9 + (z * tx - x * tz),
                s10 + (x * ty - y * tx),
                s11 + force * x,
                s12 + force * y,
                s13 + force * z,
            )
            total += force
        return sums, total, other_contacts

    def _wrench_from(
        self,
        sums: list[tuple[float, ...]],
        total: float,
        axes: tuple[float, ...],
        spin: tuple[float, float, float],
        dt: float,
    ) -> Wrench:
        """Return the wrench of all belts from the sums and the total of `_sum_contacts`."""
        _, lx, ux, _, ly, uy, _, lz, uz = axes
        wx, wy, wz = spin
        scale = self._cap / total if total > self._cap else 1.0
        turning = wx * ux + wy * uy + wz * uz
        ox = oy = oz = mx = my = mz = 0.0
        for belt, on in enumerate(sums):
            force = on[0]
            if force == 0.0:
                at = 3 * belt
                self.bends[at] = self.bends[at + 1] = self.bends[at + 2] = 0.0
                continue
            along, across, twist = self._push(belt, on, turning, dt)
            along, across, twist = scale * along, scale * across, scale * twist
            ox += along * on[5] + across * force * lx
            oy += along * on[6] + across * force * ly
            oz += along * on[7] + across * force * lz
            x, y, z = on[11], on[12], on[13]
            mx += along * on[8] + across * (y * lz - z * ly) + twist * ux
            my += along * on[9] + across * (z * lx - x * lz) + twist * uy
            mz += along * on[10] + across * (x * ly - y * lx) + twist * uz
        return ox, oy, oz, mx, my, mz

    def _push(
        self, belt: int, on: tuple[float, ...], turning: float, dt: float
    ) -> tuple[float, float, float]:
        """Update the bending of a belt's grousers by its slip, and return the push of the belt.

        `on` are the sums of the belt's contacts, `turning` is the body's turn rate (rad/s). The
        push is the forces along and to the left, each divided by the normal force, and the torque
        (N m, not divided). Grousers
        that would push harder than the grip allows slide instead.
        """
        bends, at = self.bends, 3 * belt
        normal, slip, side, ahead, square = on[:5]
        slip, side, ahead = slip / normal, side / normal, ahead / normal
        # The contacts at the ends of a flat belt represent even pressure between them.
        half = sqrt(max(0.0, square / normal - ahead * ahead))
        twist = turning * half
        k, c = self._traction.stiffness, self._traction.damping
        a, b, m = bends[at] + slip * dt, bends[at + 1] + side * dt, bends[at + 2] + twist * dt
        push_a, push_b, push_m = -k * a - c * slip, -k * b - c * side, -k * m - c * twist
        over = sqrt(push_a * push_a + push_b * push_b + push_m * push_m)
        if over > 1.0:
            push_a, push_b, push_m = push_a / over, push_b / over, push_m / over
            # A quick slip must not leave grousers bent further than they can push.
            a = max(-1.0, min(1.0, -push_a - c * slip)) / k
            b = max(-1.0, min(1.0, -push_b - c * side)) / k
            m = max(-1.0, min(1.0, -push_m - c * twist)) / k
        bends[at], bends[at + 1], bends[at + 2] = a, b, m
        side_grip = self._traction.side_grip
        torque = side_grip * normal * half / 2 * push_m
        return self._traction.grip * push_a, side_grip * push_b, torque
