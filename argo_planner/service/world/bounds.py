"""How far away things can be said to stand."""

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Pose

FARTHEST = 10_000.0
"""m from the middle of the site's frame"""
MOST_TURNED = 1_000.0
"""rad"""


def require_on_site(pose: Pose, what: str) -> None:
    """Raises Invalid for a pose that is on no site."""
    if max(abs(pose.x), abs(pose.y), abs(pose.z)) > FARTHEST:
        raise Invalid(f"{what} stands farther away than {FARTHEST:g} m, on no site")
    if abs(pose.yaw) > MOST_TURNED:
        raise Invalid(f"{what} has a yaw of {pose.yaw:g} rad: give it one of a turn")
