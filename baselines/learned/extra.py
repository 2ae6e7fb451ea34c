"""Check for the packages of the extra `learned`, which training and learned policies need."""

from importlib.util import find_spec

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line


def require_learned_extra() -> None:
    """Raise Unavailable if a package that learned policies need is not installed."""
    required = {
        "torch": "torch",
        "sb3_contrib": "sb3-contrib",
        "stable_baselines3": "stable-baselines3",
        "tensorboard": "tensorboard",
    }
    missing = [name for module, name in required.items() if find_spec(module) is None]
    if missing:
        raise Unavailable(f"learned policies need {', '.join(missing)}: {install_line('learned')}")
