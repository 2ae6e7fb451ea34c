"""Gymnasium environments, which are registered when `argo_env` is imported."""

from argo_env.envs.registration import ENVIRONMENTS

__all__ = ["ENVIRONMENTS"]
