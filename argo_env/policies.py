"""Extension point of policies, which choose the order of checkpoints.

Argo's own, of the package `baselines`, are registered as those of other packages, in
`pyproject.toml`.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module, invalidate_caches
from operator import attrgetter
from pathlib import Path
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


def import_policy(name: str, folder: Path | None = None) -> Any:
    """Import the class or function of a policy that is named as `module:name`.

    A module in `folder` comes before an installed one. Raises NotFound if there is none.
    """
    module, _, attribute = name.partition(":")
    try:
        with _modules_of(folder, module):
            return attrgetter(attribute)(import_module(module))
    except (ImportError, AttributeError, ValueError) as error:
        raise NotFound(f"policy `{name}` can't be loaded: {error}") from None


@contextmanager
def _modules_of(folder: Path | None, module: str) -> Iterator[None]:
    """Find modules in a folder first; `module` is imported anew if the folder has it."""
    if folder is None:
        yield
        return
    path = os.path.abspath(folder)
    first = module.partition(".")[0]
    if os.path.isfile(os.path.join(path, f"{first}.py")):
        sys.modules.pop(first, None)  # one of the same name in another folder
    invalidate_caches()
    sys.path.insert(0, path)
    try:
        yield
    finally:
        sys.path.remove(path)
