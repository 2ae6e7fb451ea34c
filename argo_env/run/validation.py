"""Whether what a run is made of fits together: the machine, the site and the spec."""

from dataclasses import dataclass

from argo_compiler.base.errors import Conflict
from argo_compiler.hfsm import Cause, lower
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.machine import Machine
from argo_env.run.run_commands import check_scheduled_events
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec, checked


@dataclass(frozen=True)
class CheckedRun:
    """A spec that a run on the site can have, as `check_run` has found."""

    spec: RunSpec
    site: OpenedSite


def check_run(
    spec: RunSpec | CheckedRun, site: OpenedSite | None = None, *, settings: bool = True
) -> CheckedRun:
    """Return the run of a spec, checked, on the site that it names unless that is open already.

    Without `settings` only what depends on the mission is checked: for one that became known after
    `check_spec`. What was checked on that site already is returned as it is. Raises ArgoError for
    a run that can't be.
    """
    if isinstance(spec, CheckedRun):
        if site is None or site is spec.site:
            return spec
        spec = spec.spec
    spec = checked(spec)
    site = site or open_site(spec.site, load_robot(spec.robot))
    require_site(site, spec)
    if settings:
        check_spec(spec, site.site)
    check_scheduled_events(spec.events, spec.mission, site.site)
    return CheckedRun(spec, site)


def require_machine(machine: Machine, spec: RunSpec) -> None:
    """Raises Conflict for a machine that has been started, or is another than the mission's."""
    if machine.configuration:
        raise Conflict("the machine has been started already: make another one for this run")
    progress = spec.beginning.progress if spec.beginning else None
    if machine.hfsm != lower(spec.mission, progress):
        raise Conflict(
            "the machine is not that of the spec's mission: lower the mission that the spec has"
        )


def require_begun(machine: Machine, spec: RunSpec) -> None:
    """Raises Conflict for a machine, started now, that does not stand where the run begins."""
    restored = machine.trace[0].cause is Cause.RESTORE
    expected = spec.beginning.progress.active if spec.beginning else None
    if restored != (spec.beginning is not None) or (
        restored and machine.trace[0].target != expected
    ):
        raise Conflict(
            "the machine does not stand where the run begins: make it with `make_machine` from the "
            "spec's mission and beginning"
        )


def require_site(site: OpenedSite, spec: RunSpec) -> None:
    """Raises Conflict for a site that is not the spec's, or a mission of another; ArgoError if the
    site that the spec names in other words than this one can't be opened."""
    planned = spec.mission.site
    if planned and planned != site.name:
        raise Conflict(f"the mission was planned for site {planned}, and the site is {site.name}")
    if spec.site != site.reference and open_site(spec.site).site.spec != site.site.spec:
        raise Conflict(
            f"the spec names site {spec.site}, and the site given is {site.reference}: open the "
            "one that the spec names"
        )
