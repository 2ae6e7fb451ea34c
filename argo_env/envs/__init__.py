"""Gymnasium environments; they are registered when `argo_env` is imported."""

import gymnasium as gym

ENVIRONMENTS: dict[str, dict[str, str]] = {
    "argo/Route-v0": {
        "entry_point": "argo_env.envs.route:RouteEnv",
        "vector_entry_point": "argo_env.envs.route:RouteVectorEnv",
    },
    "argo/Drive-v0": {"entry_point": "argo_env.envs.drive:DriveEnv"},
    "argo/Inspect-v0": {"entry_point": "argo_env.envs.inspection:InspectEnv"},
}
"""What is registered, by id: the tests run over all of them."""


def register_environments() -> None:
    """Makes the environments known to Gymnasium; they are loaded when one is made."""
    for id, entry_points in ENVIRONMENTS.items():
        if id not in gym.registry:
            gym.register(id, **entry_points)  # type: ignore[arg-type]
