"""Signals: what the robot senses besides checkpoints, and what it makes of that."""

from argo_env.sensing.signals.standard import standard_watches

__all__ = ["standard_watches"]
