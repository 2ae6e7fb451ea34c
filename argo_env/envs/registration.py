"""Registration of Argo's environments with Gymnasium, without importing it.

Gymnasium and NumPy take longer to import than most of the work of a command. So if Gymnasium has
been imported already, the environments are registered at once, otherwise right after its import.
"""

import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

ENVIRONMENTS: dict[str, dict[str, str]] = {
    "argo/Route-v0": {
        "entry_point": "argo_env.envs.route:RouteEnv",
        "vector_entry_point": "argo_env.envs.route_batch:RouteVectorEnv",
    },
    "argo/Drive-v0": {
        "entry_point": "argo_env.envs.drive:DriveEnv",
        "vector_entry_point": "argo_env.envs.drive:DriveVectorEnv",
    },
    "argo/Inspect-v0": {
        "entry_point": "argo_env.envs.inspection:InspectEnv",
        "vector_entry_point": "argo_env.envs.inspection:InspectVectorEnv",
    },
}
"""entry points of the registered environments, by id: the tests run over all of them"""

_GYMNASIUM = "gymnasium"


def register_with_gymnasium() -> None:
    """Register the environments with Gymnasium, now or when it is imported.

    Their modules are loaded when an environment is made.
    """
    if sys.modules.get(_GYMNASIUM):
        _register()
    elif not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())


def _register() -> None:
    import gymnasium as gym

    for id, entry_points in ENVIRONMENTS.items():
        if id not in gym.registry:
            gym.register(id, **entry_points)  # type: ignore[arg-type]


class _Finder(MetaPathFinder):
    """Finder that finds Gymnasium as others do, and registers the environments with it."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != _GYMNASIUM:
            return None
        for finder in sys.meta_path:
            if finder is not self and (spec := finder.find_spec(fullname, path, target)):
                if spec.loader:
                    spec.loader = _RegisteringLoader(spec.loader)
                return spec
        return None


class _RegisteringLoader(Loader):
    """Loader that loads a module as another loader does, then registers the environments."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        # The module keeps the other loader, which provides its resources and source.
        module.__loader__ = self._loader
        if module.__spec__:
            module.__spec__.loader = self._loader
        self._loader.exec_module(module)
        _register()
