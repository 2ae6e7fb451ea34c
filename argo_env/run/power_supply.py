"""The battery in use: what the robot draws from it, and what a dock gives back."""

from argo_compiler.il.docked import at_dock
from argo_env.drives.battery import Battery, load
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.run.log import Entry
from argo_env.site import Site


class PowerSupply:
    """Draws from a battery and charges it. Holds the battery and whether it is being charged."""

    def __init__(self, battery: Battery | None, robot: RobotSpec, site: Site) -> None:
        """Without a battery the robot has power without end."""
        self.charging = False
        self._battery = battery
        self._power = robot.power
        self._docks = tuple(site.docks.values())

    @property
    def charge(self) -> float | None:
        """Of the battery, 0 to 1."""
        return self._battery.charge if self._battery else None

    @property
    def empty(self) -> bool:
        """Whether the battery is."""
        return self._battery is not None and self._battery.empty

    def restore(self, entry: Entry) -> None:
        """Goes on from an entry."""
        if entry.charge is not None:
            self.begin(entry.charge, entry.body_pose)

    def begin(self, charge: float, pose: BodyPose) -> None:
        """Goes on with such a charge (0 to 1), the robot at `pose`."""
        if self._battery:
            self._battery.charge = charge
            # If it does not stand there, the next step shows it.
            self.charging = charge < 1.0 and self._docked(pose)

    def spend(self, before: BodyPose, after: BodyPose, seconds: float, measuring: bool) -> None:
        """Draws what the way between two poses took, or charges while the robot stands docked."""
        if self._battery is None:
            return
        watts = load(self._power, before, after, seconds, measuring)
        stands = watts in (self._power.standing, self._power.measuring)
        docked = stands and self._docked(after)
        self.charging = docked and self._battery.charge < 1.0
        if docked:
            # The station powers the robot, and what it gives besides goes into the battery.
            watts = -self._power.charging if self.charging else 0.0
        self._battery.use(watts, seconds)

    def _docked(self, pose: BodyPose) -> bool:
        return any(at_dock(pose, dock) for dock in self._docks)
