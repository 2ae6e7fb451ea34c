"""Whether what a run is made of fits together: the machine, the site and the spec."""

from argo_compiler.errors import Conflict
from argo_compiler.hfsm import lower
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.run.machine import Machine
from argo_env.run.spec import RunSpec


def require_machine(machine: Machine, spec: RunSpec) -> None:
    """Raises Conflict for a machine that has been started, or is another than the mission's."""
    if machine.configuration:
        raise Conflict("the machine has been started already: make another one for this run")
    if machine.hfsm != lower(spec.mission):
        raise Conflict(
            "the machine is not that of the spec's mission: lower the mission that the spec has"
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
