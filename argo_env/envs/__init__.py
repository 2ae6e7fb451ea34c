"""Gymnasium environments; Gymnasium knows them as soon as `argo_env` is imported."""

from argo_env.envs.registration import ENVIRONMENTS

__all__ = ["ENVIRONMENTS"]
