"""Extension point of policies, which choose the order of checkpoints.

Argo's own, of the package `baselines`, are registered as those of other packages, in
`pyproject.toml`.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module, invalidate_caches
from importlib.machinery import PathFinder
from operator import attrgetter
from pathlib import Path
from types import ModuleType
from typing import Any

from argo_compiler.base.errors import NotFound
from argo_compiler.base.extensions import ExtensionPoint, function_problem
from argo_env.evaluation.case import AS_WRITTEN

OPTIMISED = "optimised"
"""name of the policy of an evaluation that uses the best order, as `argo route` finds it"""

POLICIES: ExtensionPoint[Callable[..., Any]] = ExtensionPoint(
    "argo.policies", "policy", {}, function_problem, reserved=(AS_WRITTEN, OPTIMISED)
)
"""Classes of policies by name, or functions that return policies.

A policy plays episodes of `argo/Route-v0` (see `baselines.policy.Policy`). It may also order the
tasks of missions in evaluations: then its class has a static method `order_tasks(mission, site)`,
which returns the mission in the new order; `site` is the opened site.
"""


def import_policy(name: str) -> Any:
    """Import the class or function of a policy that is named as `module:name`.

    Raises NotFound if there is none.
    """
    module, _, attribute = name.partition(":")
    try:
        return attrgetter(attribute)(import_module(module))
    except (ImportError, AttributeError, ValueError) as error:
        raise NotFound(f"policy `{name}` can't be loaded: {error}") from None


@contextmanager
def modules_of_policy_in(folder: Path, name: str) -> Iterator[None]:
    """Find modules in a folder before installed ones while a policy is imported and called.

    The module or package that `name` begins with, which is as for `import_policy`, is imported anew
    unless it is a package of this folder already. Further modules in the folder are not: those of
    two folders need different names.
    """
    path = os.path.abspath(folder)
    first = name.partition(":")[0].partition(".")[0]
    invalidate_caches()
    found = PathFinder.find_spec(first, [path])
    if found is not None and not _is_package_from(sys.modules.get(first), found.origin):
        for loaded in [*sys.modules]:
            if loaded.partition(".")[0] == first:
                del sys.modules[loaded]
    sys.path.insert(0, path)
    try:
        yield
    finally:
        sys.path.remove(path)


def _is_package_from(module: ModuleType | None, origin: str | None) -> bool:
    """Return True if a module is a package with this `__init__.py`; None: with any."""
    loaded = getattr(module, "__spec__", None)
    if loaded is None or loaded.origin is None or loaded.submodule_search_locations is None:
        return False
    return origin in (None, loaded.origin)
