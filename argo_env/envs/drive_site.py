"""The sites that Drive-v0 is asked to drive on, kept ready: the world of each, the robot's body in
it, and the ways there."""

from pydantic import Field, StrictInt

from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.closing import Closing
from argo_env.drives.tracked.body import TrackedBody
from argo_env.envs.guide import Guide
from argo_env.envs.options import LONGEST, check_floors
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

ON_THE_WAY = tuple(
    k for k, fault in KINDS.items() if fault.changed_elements is not Fault.changed_elements
)
"""kinds of faults that change the site"""
DYSFUNCTION = "drive_dysfunction"
_PICTURE = (640, 360)  # px


class DriveSite(Closing):
    """Holds two PyBullet connections, and a third one once it has drawn; close it."""

    def __init__(self, scenario: str, faults: tuple[AnyFault, ...] = ()) -> None:
        """Places the faults by their own seeds, 0 where they have none.

        Raises ArgoError if there is no such site, or faults that the environment does not know.
        """
        for fault in faults:
            if fault.kind not in (*ON_THE_WAY, DYSFUNCTION):
                raise NotFound(
                    f"argo/Drive-v0 does not know the fault `{fault.kind}`; "
                    f"it knows: {', '.join((*ON_THE_WAY, DYSFUNCTION))}"
                )
        navigator = open_site(scenario).prepare().navigator
        site = navigator.site
        resolved = resolve_faults(faults, site, 0)
        real = site_with_faults(site, resolved)
        if real.elements != site.elements:
            # The way shown and the progress made are those of the site as it is.
            navigator = Navigator(real, navigator.robot)
        self.site = site
        self.robot = navigator.robot
        self.navigator = navigator
        self.guide = Guide(navigator)
        self.dysfunctions = tuple(f for f in resolved if isinstance(f, DriveDysfunction))
        self._real = real
        self.world = World(site, self.robot, elements=real.elements, drawn=False)
        self.body = TrackedBody(self.world, self.robot)
        self._scene: Scene | None = None
        self._camera: ChaseCamera | None = None

    def close(self) -> None:
        """Ends the connections."""
        self.body.close()
        self.world.close()
        if self._scene:
            self._scene.close()
            self._scene = None

    def speed_share(self, now: float) -> float:
        """The share of its speed that the drive makes at time `now` (s)."""
        shares = [
            f.speed or 0.0
            for f in self.dysfunctions
            if f.start_time <= now and (f.end_time is None or now < f.end_time)
        ]
        return min(shares, default=1.0)

    def look(self, pose: BodyPose, flipper: float) -> tuple[CameraView, Camera]:
        """The robot from behind, 640 × 360 px, and the camera; `flipper` in degrees."""
        if self._scene is None:
            self._scene = Scene(self._real, self.robot)
            self._camera = None
        if self._camera is None:
            self._camera = ChaseCamera(self._scene, _PICTURE, 0.1)
        self._scene.show_floors(self.site.floor_at(pose.z))
        joints = {f"{side}_flipper_joint": flipper for side in ("left", "right")}
        self._scene.place_robot(pose, self.robot.arm_stowed | joints)
        camera = self._camera.follow(pose)
        return self._scene.look(camera), camera

    def forget_view(self) -> None:
        """The next picture is taken from where the robot is seen best, whatever came before."""
        self._camera = None


NEAREST = 5.0
"""s that a start is away from its goal at least"""
_KEPT = 4  # sites that are kept ready
_NO_SITE = "argo/Drive-v0 needs a `scenario`: the name of a site, or of several"


class DriveOptions(Model):
    """What `reset(options=...)` of Drive-v0 may say."""

    scenario: str | tuple[str, ...] | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: tuple[AnyFault, ...] = ()
    max_way: float | None = Field(default=None, ge=NEAREST, le=LONGEST, strict=True)

    @property
    def floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


class DriveSites:
    """Makes the sites that the options ask for, and `scenarios` where they name none; close it."""

    def __init__(self, scenarios: tuple[str, ...]) -> None:
        if not scenarios:
            raise Invalid(_NO_SITE)
        self.options = DriveOptions()
        self._scenarios = scenarios
        self._ready: dict[str, DriveSite] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Of the sites that an episode may be on."""
        return self._names(self.options)

    def _names(self, options: DriveOptions) -> tuple[str, ...]:
        given = options.scenario
        return self._scenarios if given is None else (given,) if isinstance(given, str) else given

    def choose(self, options: DriveOptions) -> None:
        """Takes the options on; ArgoError if a site does not have what they ask for, and then all
        is as it was."""
        names = self._names(options)
        if not names:
            raise Invalid(_NO_SITE)
        same = options.faults == self.options.faults
        made: dict[str, DriveSite] = {}
        try:
            for name in names:
                site = self._ready.get(name) if same else None
                if site is None:
                    site = made.pop(name, None) or DriveSite(name, options.faults)
                    _keep(made, name, site)
                check_floors(name, site.guide.floors, options.floors)
        except ArgoError:
            for site in made.values():
                site.close()
            raise
        if not same:
            self.close()
        self.options = options
        for name, site in made.items():
            _keep(self._ready, name, site)

    def make(self, name: str) -> DriveSite:
        """The site of that name, ready; the ones used longest ago make room for it."""
        site = self._ready.pop(name, None) or DriveSite(name, self.options.faults)
        _keep(self._ready, name, site)
        return site

    def close(self) -> None:
        """Closes the sites; they are made again when they are asked for."""
        for site in self._ready.values():
            site.close()
        self._ready.clear()


def _keep(sites: dict[str, DriveSite], name: str, site: DriveSite) -> None:
    """Adds the site; the ones added longest ago make room for it."""
    sites[name] = site
    while len(sites) > _KEPT:
        sites.pop(next(iter(sites))).close()
