"""Flaws that keep the robot from driving on a site, each with its position and a remedy."""

from argo_env.planning.flaws.flaw import Flaw
from argo_env.planning.flaws.safe_states import SafeStates
from argo_env.planning.flaws.site_check import SiteCheck, find_flaws

__all__ = ["Flaw", "SafeStates", "SiteCheck", "find_flaws"]
