"""Route for the kinds of faults, from which clients make forms."""

from collections.abc import Sequence

from fastapi import Response

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_env.faults.description import FaultDescription, describe_faults
from argo_env.faults.kinds import AnyFault, find_site_errors
from argo_env.site import Site
from argo_planner.service.web.requests import Service, Viewer, json_response, make_router

router = make_router("faults")


class FaultKinds(Model):
    """Kinds of faults."""

    kinds: tuple[FaultDescription, ...]


@router.get("/faults", operation_id="list_faults", response_model=FaultKinds)
async def list_faults(service: Service, _: Viewer) -> Response:
    """Return the kinds of faults with their fields, units, limits and what the site allows."""
    return json_response(FaultKinds(kinds=describe_faults(service.site.site)))


def require_faults_on_site(faults: Sequence[AnyFault], site: Site, seed: int) -> None:
    """Raise Invalid, with the indices in the list, for faults that do not fit the site."""
    if errors := find_site_errors(faults, site, seed):
        raise Invalid(Message("{errors:;}", errors=tuple(errors.values())))
