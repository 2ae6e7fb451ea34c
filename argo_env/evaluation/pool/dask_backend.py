"""Back end with the workers of a Dask cluster, on this machine or at an address."""

import asyncio
import logging
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import dask
from distributed import Client, KilledWorker, LocalCluster, rpc
from distributed import wait as wait_for
from distributed.client import FutureCancelledError

from argo_compiler.base.errors import Unavailable
from argo_env.evaluation.pool.backend import WorkerDiedError, require_listener

_LOGGERS = tuple(f"distributed{part}" for part in ("", ".scheduler", ".nanny", ".core", ".worker"))
_SCHEDULER_TIMEOUT = 10.0  # s until a scheduler has identified itself
_SETTINGS = {
    # The pool repeats calls itself, as it knows whether a call was alone when its worker died.
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.comm.timeouts.connect": "20s",
    # On a busy machine a dead worker takes longer than the default of 15 s to be restarted; its
    # nanny would then be closed for good, and calls would wait forever.
    "distributed.deploy.lost-worker-timeout": "1h",
    "distributed.admin.log-format": "%(message)s",
}


class DaskBackend:
    """Back end with Dask's workers and futures; a dying worker may lose calls that wait for it."""

    name = "dask"
    isolates_deaths = False

    def __init__(self, workers: int | None, address: str | None = None) -> None:
        """Connect to the cluster at the address, or start one on this machine if it is None.

        `workers` None stands for one worker for each thread of an existing cluster, or for each
        processor of this machine. Raises Unavailable if the cluster can't be reached or started.
        """
        for name in _LOGGERS:
            logging.getLogger(name).setLevel(logging.CRITICAL)
        dask.config.set(_SETTINGS)
        if address is not None:
            _require_scheduler(address)
        self._cluster: Any = None
        try:
            if address is None:
                self._cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address="127.0.0.1:0",
                    scheduler_kwargs={"dashboard": False},
                    silence_logs=logging.CRITICAL,
                )
            self._client = Client(self._cluster if address is None else address)
        except (OSError, ValueError, RuntimeError) as error:
            where = f" at {address}" if address else ""
            raise Unavailable(f"no Dask cluster{where}: {error}") from None
        self.workers = workers or max(1, sum(self._client.nthreads().values()))

    def submit(self, function: Callable[[Any], Any], argument: Any) -> Any:
        return self._client.submit(function, argument, pure=False)

    def wait(self, calls: Sequence[Any]) -> Sequence[Any]:
        if not calls:
            return ()
        ended = wait_for(list(calls), return_when="FIRST_COMPLETED").done
        return [call for call in calls if call in ended]

    def result(self, call: Any) -> Any:
        try:
            return call.result()
        except KilledWorker:
            raise WorkerDiedError("the worker process ended") from None
        except FutureCancelledError as error:
            raise WorkerDiedError(f"the call was lost: {error}") from None
        finally:
            call.release()

    def replace_dead_workers(self) -> None:
        """Do nothing, as Dask's nannies start new workers themselves."""

    def close(self) -> None:
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()


def _require_scheduler(address: str) -> None:
    """Raise ArgoError if no scheduler answers at the address; a client would wait forever."""
    require_listener(address, "Dask")

    async def query_type() -> str:
        async with asyncio.timeout(_SCHEDULER_TIMEOUT), rpc(address) as scheduler:
            return str((await scheduler.identity()).get("type"))

    try:
        # A separate thread is needed, as a notebook has an event loop in this one.
        with ThreadPoolExecutor(1) as thread:
            kind = thread.submit(asyncio.run, query_type()).result()
    except Exception as error:  # another server may answer with anything
        why = "the server there does not answer as one" if isinstance(error, OSError) else error
        raise Unavailable(f"no Dask cluster at {address}: {why}") from None
    if kind != "Scheduler":
        raise Unavailable(f"no Dask cluster at {address}: it is the address of a {kind}")
