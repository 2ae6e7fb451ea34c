"""Back ends by name; each imports the packages that it needs when it is made."""

from collections.abc import Callable
from importlib.util import find_spec

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.worker_processes import WorkerContext, usable_processors

PROCESSES = "processes"


def _processes(
    workers: int | None, address: str | None, context: WorkerContext | None
) -> WorkerBackend:
    if address is not None:
        raise Invalid(
            "processes run on this machine and have no address: name the back end `ray` or `dask`"
        )
    from argo_env.evaluation.pool.process_backend import ProcessBackend

    return ProcessBackend(workers or usable_processors(), context)


def _ray(workers: int | None, address: str | None, _: object) -> WorkerBackend:
    _require("ray")
    from argo_env.evaluation.pool.ray_backend import RayBackend

    return RayBackend(workers or (None if address else usable_processors()), address)


def _dask(workers: int | None, address: str | None, _: object) -> WorkerBackend:
    _require("distributed")
    from argo_env.evaluation.pool.dask_backend import DaskBackend

    return DaskBackend(workers or (None if address else usable_processors()), address)


BACKENDS: dict[str, Callable[[int | None, str | None, WorkerContext | None], WorkerBackend]] = {
    PROCESSES: _processes,
    "ray": _ray,
    "dask": _dask,
}
"""Factories of the back ends, by name.

They take the number of workers (None: one for each processor of this machine, or all of an existing
cluster), the address of a cluster (None: this machine), and the multiprocessing context that starts
processes on this machine.
"""


def make_backend(
    name: str = PROCESSES,
    workers: int | None = None,
    address: str | None = None,
    context: WorkerContext | None = None,
) -> WorkerBackend:
    """Return the back end with this name, with its workers started.

    Args:
        name: Name of the back end in `BACKENDS`.
        workers: Number of workers; None for one for each processor of this machine, or for all of
            an existing cluster.
        address: Address of an existing cluster; None for this machine.
        context: Multiprocessing context that starts worker processes on this machine; without it
            each worker imports all modules itself.

    Raises:
        ArgoError: If there is no such back end, or it can't be started with these arguments.
    """
    if name not in BACKENDS:
        raise Invalid(f"no back end `{name}`; there are: {', '.join(BACKENDS)}")
    if workers is not None and workers < 1:
        raise Invalid(f"{workers} workers can't execute anything: give 1 or more")
    return BACKENDS[name](workers, address, context)


def _require(module: str) -> None:
    if find_spec(module) is None:
        raise Unavailable(f"the package `{module}` is not installed: {install_line('cluster')}")
