"""Packages whose drives, sensors and faults a run uses."""

from argo_env.faults.kinds import FAULTS
from argo_env.run.drives_and_sensors import SENSORS, WORLD_DRIVES
from argo_env.run.spec import RunSpec


def packages_of_run(spec: RunSpec) -> tuple[str, ...]:
    """Return the names and versions of the packages, without Argo, that a run depends on."""
    packages = {WORLD_DRIVES.package_of(spec.drive), SENSORS.package_of(spec.sensor)}
    packages |= {FAULTS.package_of(fault.kind) for fault in spec.faults}
    return tuple(sorted(package for package in packages if package is not None))
