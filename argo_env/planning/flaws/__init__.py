"""Why a site can't be driven: what is wrong, where, and the way out."""

from argo_env.planning.flaws.finding import SiteCheck, look_over
from argo_env.planning.flaws.flaw import Flaw
from argo_env.planning.flaws.standing import Standing

__all__ = ["Flaw", "SiteCheck", "Standing", "look_over"]
