"""Version of Argo."""

__version__ = "0.1.0"
