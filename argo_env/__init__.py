"""The site: scenarios, geometry, navigation, robot, sensing, the mission runner and its reports."""

from argo_env.envs import register_environments

register_environments()
