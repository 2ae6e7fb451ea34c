"""Sites of Drive-v0, each with a world, the robot's body and a guide; they are cached."""

from pydantic import Field, StrictInt

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.closing import Closing
from argo_env.drives.tracked.body import TrackedBody
from argo_env.envs.guide import Guide
from argo_env.envs.options import MAX_DURATION, check_floors
from argo_env.faults.fault import Fault
from argo_env.faults.kinds import KINDS, AnyFault, resolve_faults, site_with_faults
from argo_env.faults.robot import DriveDysfunction
from argo_env.navigation import Navigator
from argo_env.pictures.camera import Camera
from argo_env.pictures.chase import ChaseCamera
from argo_env.pictures.scene import CameraView, Scene
from argo_env.planning import open_site
from argo_env.robot.pose import BodyPose
from argo_env.world.world import World


def _changes_site(fault: type[Fault]) -> bool:
    return fault.site_elements_with_fault is not Fault.site_elements_with_fault


SITE_FAULTS = tuple(kind for kind, fault in KINDS.items() if _changes_site(fault))
"""Argo's kinds of faults that change the site"""
DRIVE_FAULT = "drive_dysfunction"
_PICTURE = (640, 360)  # px


class DriveSite(Closing):
    """Site with a world, the robot's body in it, and a guide to goals. Close it.

    It holds two PyBullet connections, and a third one after it has drawn a picture.
    """

    def __init__(self, scenario: str, faults: tuple[AnyFault, ...] = ()) -> None:
        """Build the site with its faults.

        What a fault leaves open is drawn with its own seed, 0 if it has none. Raises ArgoError if
        there is no such site, or if the environment does not support a fault.
        """
        for fault in faults:
            if not _changes_site(type(fault)) and fault.kind != DRIVE_FAULT:
                raise NotFound(
                    f"argo/Drive-v0 does not support the fault `{fault.kind}`; "
                    f"it supports: {', '.join((*SITE_FAULTS, DRIVE_FAULT))}"
                )
        navigator = open_site(scenario).prepare().navigator
        site = navigator.site
        resolved = resolve_faults(faults, site, 0)
        actual = site_with_faults(site, resolved)
        if actual.elements != site.elements:
            # Waypoints and progress are those of the site with its faults.
            navigator = Navigator(actual, navigator.robot)
        self.site = site
        self.robot = navigator.robot
        self.navigator = navigator
        self.guide = Guide(navigator)
        self.dysfunctions = tuple(f for f in resolved if isinstance(f, DriveDysfunction))
        self._actual_site = actual
        self.world = World(site, self.robot, elements=actual.elements, drawn=False)
        self.body = TrackedBody(self.world, self.robot)
        self._scene: Scene | None = None
        self._camera: ChaseCamera | None = None

    def close(self) -> None:
        """Close all connections to PyBullet."""
        self.body.close()
        self.world.close()
        if self._scene:
            self._scene.close()
            self._scene = None

    def speed_factor_from_faults(self, now: float) -> float:
        """Return the factor, 0 to 1, by which faults reduce the drive's speed at time `now` (s).

        `now` counts from the start of the episode.
        """
        shares = [
            f.speed or 0.0
            for f in self.dysfunctions
            if f.start_time <= now and (f.end_time is None or now < f.end_time)
        ]
        return min(shares, default=1.0)

    def render_from_behind(self, pose: BodyPose, flipper: float) -> tuple[CameraView, Camera]:
        """Return a picture of the robot at `pose` from behind, 640 × 360 px, and its camera.

        `flipper` is the angle of the flippers in degrees. The camera moves on from the previous
        picture.
        """
        if self._scene is None:
            self._scene = Scene(self._actual_site, self.robot)
            self._camera = None
        if self._camera is None:
            self._camera = ChaseCamera(self._scene, _PICTURE, 0.1)
        self._scene.show_floors(self.site.floor_at(pose.z))
        joints = {f"{side}_flipper_joint": flipper for side in ("left", "right")}
        self._scene.place_robot(pose, self.robot.arm_stowed | joints)
        camera = self._camera.next_camera(pose)
        return self._scene.render_from(camera), camera

    def forget_camera_position(self) -> None:
        """Drop the camera, so that the next picture does not depend on earlier ones."""
        self._camera = None


MIN_TRAVEL_TIME = 5.0
"""shortest travel time (s) from a start to its goal"""
_CACHED_SITES = 4  # sites at most
_NO_SITE = "argo/Drive-v0 needs a `scenario`: the name of a site, or of several"


class DriveOptions(Model):
    """Options for `reset(options=...)` of Drive-v0."""

    scenario: str | tuple[str, ...] | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: tuple[AnyFault, ...] = ()
    max_way: float | None = Field(default=None, ge=MIN_TRAVEL_TIME, le=MAX_DURATION, strict=True)

    @property
    def given_floors(self) -> tuple[int, ...]:
        """Floors that the option `floor` names; empty if it names none."""
        return (self.floor,) if isinstance(self.floor, int) else self.floor


class DriveSites:
    """Cache of the sites that the options name, or `scenarios` if they name none. Close it."""

    def __init__(self, scenarios: tuple[str, ...]) -> None:
        if not scenarios:
            raise Invalid(_NO_SITE)
        self.options = DriveOptions()
        self._scenarios = scenarios
        self._cached: dict[str, DriveSite] = {}

    @property
    def requested_site_names(self) -> tuple[str, ...]:
        """Names of the sites that an episode may be on."""
        return self._requested_names(self.options)

    def _requested_names(self, options: DriveOptions) -> tuple[str, ...]:
        given = options.scenario
        return self._scenarios if given is None else (given,) if isinstance(given, str) else given

    def apply_options(self, options: DriveOptions) -> None:
        """Set the options for the episodes that begin from now on, and build the sites they name.

        Cached sites with other faults are closed. Raises ArgoError if there is no such site, if it
        does not have the floors, or if a fault is not possible there; then nothing changes.
        """
        names = self._requested_names(options)
        if not names:
            raise Invalid(_NO_SITE)
        same_faults = options.faults == self.options.faults
        added: dict[str, DriveSite] = {}
        try:
            for name in names:
                site = self._cached.get(name) if same_faults else None
                if site is None:
                    site = added.pop(name, None) or DriveSite(name, options.faults)
                    _add_to_cache(added, name, site)
                check_floors(name, site.guide.floors, options.given_floors)
        except BaseException:
            for site in added.values():
                site.close()
            raise
        if not same_faults:
            self.close()
        self.options = options
        for name, site in added.items():
            _add_to_cache(self._cached, name, site)

    def get_site(self, name: str) -> DriveSite:
        """Return the site with this name from the cache, or build it.

        A full cache closes its least recently used site.
        """
        site = self._cached.pop(name, None) or DriveSite(name, self.options.faults)
        _add_to_cache(self._cached, name, site)
        return site

    def close(self) -> None:
        """Close the sites; they are built again when they are needed."""
        for site in self._cached.values():
            site.close()
        self._cached.clear()


def _add_to_cache(sites: dict[str, DriveSite], name: str, site: DriveSite) -> None:
    """Add the site; if the cache is full, close and remove the least recently used one."""
    sites[name] = site
    while len(sites) > _CACHED_SITES:
        sites.pop(next(iter(sites))).close()
