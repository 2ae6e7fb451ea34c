"""What training and the learned policies need besides Argo."""

from importlib.util import find_spec

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line


def check_learned() -> None:
    """Raises ArgoError if something is missing."""
    wanted = {
        "torch": "torch",
        "sb3_contrib": "sb3-contrib",
        "stable_baselines3": "stable-baselines3",
        "tensorboard": "tensorboard",
    }
    missing = [name for module, name in wanted.items() if find_spec(module) is None]
    if missing:
        raise Unavailable(f"learned policies need {', '.join(missing)}: {install_line('learned')}")
