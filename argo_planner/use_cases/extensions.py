"""List of all that installed packages offer to extend Argo."""

import logging
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from argo_compiler.base.extensions import ExtensionPoint, InstalledExtension, installed_names

_log = logging.getLogger(__name__)

_POINTS = {
    "argo.exporters": ("argo_compiler.export", "EXPORTERS"),
    "argo.sensors": ("argo_env.run.drives_and_sensors", "SENSORS"),
    "argo.drives": ("argo_env.run.drives_and_sensors", "WORLD_DRIVES"),
    "argo.faults": ("argo_env.faults.kinds", "FAULTS"),
    "argo.solvers": ("argo_compiler.route.solvers", "SOLVERS"),
    "argo.policies": ("argo_env.policies", "POLICIES"),
    "argo.responses": ("argo_compiler.il.responses", "RESPONSES"),
}
"""module and name of each extension point, by its group; a module is imported only for packages
that offer something in the group, since some take a second"""


def find_extensions() -> Iterator[InstalledExtension]:
    """Import and yield all that installed packages offer, also what can't be used."""
    for group, (module, name) in _POINTS.items():
        if not installed_names(group):
            continue
        point: ExtensionPoint[Any] = getattr(import_module(module), name)
        yield from point.extensions()


def usable_extensions() -> tuple[InstalledExtension, ...]:
    """Import and return what installed packages offer; log a warning for what can't be used."""
    usable = []
    for one in find_extensions():
        if one.problem is None:
            usable.append(one)
        else:
            _log.warning("the %s `%s` of %s %s", one.kind, one.name, one.package, one.problem)
    return tuple(usable)
