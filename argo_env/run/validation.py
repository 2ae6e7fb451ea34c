"""Validation of a run: its machine, its site and its spec must belong together."""

from dataclasses import dataclass

from argo_compiler.base.errors import Conflict
from argo_compiler.base.message import Message
from argo_compiler.hfsm import Cause, lower
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.robot.spec import load_robot
from argo_env.run.machine import Machine
from argo_env.run.run_commands import check_scheduled_events
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec, validate_spec


@dataclass(frozen=True)
class CheckedRun:
    """Spec and site of a run that `check_run` has accepted."""

    spec: RunSpec
    site: OpenedSite


def check_run(
    spec: RunSpec | CheckedRun, site: OpenedSite | None = None, *, settings: bool = True
) -> CheckedRun:
    """Check the spec of a run and return it with its site.

    Args:
        spec: the spec; a run that was already checked on this site is returned unchanged.
        site: the opened site that the spec names; None: it is opened.
        settings: False: only what depends on the mission is checked, for a mission that became
            known after `check_spec`.

    Raises:
        ArgoError: there can be no such run.
    """
    if isinstance(spec, CheckedRun):
        if site is None or site is spec.site:
            return spec
        spec = spec.spec
    spec = validate_spec(spec)
    site = site or open_site(spec.site, load_robot(spec.robot))
    require_site(site, spec)
    if settings:
        check_spec(spec, site.site)
    check_scheduled_events(spec.events, spec.mission, site.site)
    return CheckedRun(spec, site)


def require_unstarted_machine(machine: Machine, spec: RunSpec) -> None:
    """Raise Conflict for a machine that has been started, or is not that of the spec's mission."""
    if machine.configuration:
        raise Conflict("the machine has been started already: make another one for this run")
    progress = spec.beginning.progress if spec.beginning else None
    if machine.hfsm != lower(spec.mission, progress):
        raise Conflict(
            "the machine is not that of the spec's mission: lower the mission that the spec has"
        )


def require_initial_state(machine: Machine, spec: RunSpec) -> None:
    """Raise Conflict unless the machine, just started, is in the initial state of the run."""
    restored = machine.trace[0].cause is Cause.RESTORE
    expected = spec.beginning.progress.active if spec.beginning else None
    if restored != (spec.beginning is not None) or (
        restored and machine.trace[0].target != expected
    ):
        raise Conflict(
            "the machine is not in the state in which the run begins: make it with `make_machine` "
            "from the spec's mission and beginning"
        )


def require_site(site: OpenedSite, spec: RunSpec) -> None:
    """Raise Conflict for a site that is not that of the spec, or not that of its mission.

    If the spec refers to the site by another name or path, the sites' descriptions are compared;
    raises ArgoError if that of the spec can't be opened for this.
    """
    planned = spec.mission.site
    if planned and planned != site.name:
        raise Conflict(
            Message(
                "the mission was planned for site {planned}, and the site is {site}",
                planned=planned,
                site=site.name,
            )
        )
    if spec.site != site.reference and open_site(spec.site).site.spec != site.site.spec:
        raise Conflict(
            Message(
                "the spec names site {site}, and the site given is {reference}: open the "
                "one that the spec names",
                site=spec.site,
                reference=site.reference,
            )
        )
