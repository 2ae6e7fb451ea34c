"""Generated sites that the robot can drive: a draw that it can't drive is replaced."""

from argo_compiler.base.errors import ArgoError, Unreachable
from argo_compiler.base.message import Message
from argo_env.navigation.navigator import Navigator
from argo_env.planning.checking import unpatrolled_floors, unseen_checkpoints
from argo_env.robot.spec import RobotSpec, load_robot
from argo_env.site.families import draw_site_and_slots
from argo_env.site.family import Family
from argo_env.site.site import make_site

_LAYOUTS = 5  # maximum number of layouts that are drawn
_ROUNDS = 8  # maximum number of times that unreadable checkpoints are moved, for each layout


def generate_navigator(family: Family, robot: RobotSpec | None = None) -> Navigator:
    """Generate the site that a family's parameters define, and return its navigator.

    The robot can get from every docking station to every floor and to a viewing pose of every
    checkpoint, and back. Checkpoints that it can't read are moved; if that does not help, or if it
    can't reach a floor, another layout is drawn. Equal arguments give the same site. It is not
    cached: `open_site` caches it.

    Args:
        family: Parameters of the site.
        robot: Robot that must be able to drive there; None: the tracker.

    Raises:
        Unreachable: The robot can't drive any of the draws.
        ArgoError: The checkpoints do not fit on a site of this size.
    """
    robot = robot or load_robot()
    for attempt in range(_LAYOUTS):
        refused: set[tuple[int, int]] = set()
        for _ in range(_ROUNDS):
            spec, slots = draw_site_and_slots(family, attempt, refused)
            navigator = Navigator(make_site(spec), robot)
            try:
                _ = navigator.lattice
            except ArgoError:  # a docking station can't be reached
                break
            if unpatrolled_floors(navigator):
                break
            unseen = unseen_checkpoints(navigator)
            if not unseen:
                return navigator
            refused |= {slots[id] for id in unseen}
    raise Unreachable(
        Message(
            "site `{family}`: no draw of this seed can be driven by the {robot}; "
            "choose another seed or less clutter",
            family=family,
            robot=robot.name,
        )
    )
