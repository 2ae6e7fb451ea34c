"""Version of Argo."""

__version__ = "0.2.0"
