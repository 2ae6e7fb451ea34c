"""Extension point of policies, which choose the order of checkpoints.

Argo's own, of the package `baselines`, are registered as those of other packages, in
`pyproject.toml`.
"""

from collections.abc import Callable
from importlib import import_module
from operator import attrgetter
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
