"""The back ends by name. What one of them needs is imported when it is made."""

from collections.abc import Callable
from importlib.util import find_spec
from multiprocessing.context import ForkServerContext

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.worker_processes import usable_processors

PROCESSES = "processes"


def _processes(
    workers: int | None, address: str | None, context: ForkServerContext | None
) -> WorkerBackend:
    if address is not None:
        raise Invalid("processes are of this machine and have no address: take `ray` or `dask`")
    from argo_env.evaluation.pool.processes import Processes

    return Processes(workers or usable_processors(), context)


def _ray(workers: int | None, address: str | None, _: object) -> WorkerBackend:
    _require("ray")
    from argo_env.evaluation.pool.on_ray import RayCluster

    return RayCluster(workers or (None if address else usable_processors()), address)


def _dask(workers: int | None, address: str | None, _: object) -> WorkerBackend:
    _require("distributed")
    from argo_env.evaluation.pool.on_dask import DaskCluster

    return DaskCluster(workers or (None if address else usable_processors()), address)


BACKENDS: dict[str, Callable[[int | None, str | None, ForkServerContext | None], WorkerBackend]] = {
    PROCESSES: _processes,
    "ray": _ray,
    "dask": _dask,
}
"""Functions that make the back ends. They take a number of workers (None: all that there are), the
address of a cluster (None: this machine), and the context in which processes of this machine
begin."""


def make_backend(
    name: str = PROCESSES,
    workers: int | None = None,
    address: str | None = None,
    context: ForkServerContext | None = None,
) -> WorkerBackend:
    """Return the back end of that name, with its workers begun.

    `context`: the one in which worker processes of this machine begin; without it each loads anew
    what it needs. Raises ArgoError if there can be no such back end.
    """
    if name not in BACKENDS:
        raise Invalid(f"no back end `{name}`; there are: {', '.join(BACKENDS)}")
    if workers is not None and workers < 1:
        raise Invalid(f"{workers} workers can't do anything: give 1 or more")
    return BACKENDS[name](workers, address, context)


def _require(module: str) -> None:
    if find_spec(module) is None:
        raise Unavailable(f"the package `{module}` is not installed: {install_line('cluster')}")
