"""Generated sites that have been checked: what can't be driven is drawn again."""

from argo_compiler.base.errors import ArgoError, Unreachable
from argo_env.navigation.navigator import Navigator
from argo_env.planning.checking import unseen_checkpoints, unserved_floors
from argo_env.robot.spec import RobotSpec, load_robot
from argo_env.site.families import draw_site
from argo_env.site.family import Family
from argo_env.site.site import make_site

_LAYOUTS = 5  # that are drawn before giving up
_ROUNDS = 8  # of moving checkpoints that can't be read, for each layout


def generate(family: Family, robot: RobotSpec | None = None) -> Navigator:
    """The navigator of the site that the family's parameters give: `open_site` keeps what this
    draws anew each time.

    The robot (the tracker, unless told otherwise) gets from every docking station to every floor,
    and to a view of every checkpoint, and back. Where a draw does not give that, its checkpoints
    are moved, and then the next draw is taken, in an order that only the parameters decide.

    Raises ArgoError if the checkpoints do not fit on a site of this size.
    """
    robot = robot or load_robot()
    for attempt in range(_LAYOUTS):
        refused: set[tuple[int, int]] = set()
        for _ in range(_ROUNDS):
            spec, slots = draw_site(family, attempt, refused)
            navigator = Navigator(make_site(spec), robot)
            try:
                _ = navigator.lattice
            except ArgoError:  # a docking station that nothing leads to
                break
            if unserved_floors(navigator):
                break
            unseen = unseen_checkpoints(navigator)
            if not unseen:
                return navigator
            refused |= {slots[id] for id in unseen}
    raise Unreachable(
        f"site `{family}`: no draw of this seed can be driven by the {robot.name}; take another"
        " seed or less clutter"
    )
