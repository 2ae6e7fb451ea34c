"""Workers of a Dask cluster: one of this machine, or an existing one by its address."""

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
_PATIENCE = 10.0  # s until a scheduler has said that it is one
_SETTINGS = {
    # A call is tried again by the pool, which knows when it was alone.
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.comm.timeouts.connect": "20s",
    # On a busy machine a worker that has died takes longer than the 15 s of the default to be there
    # again; then its nanny would be closed for good, and calls would wait for ever.
    "distributed.deploy.lost-worker-timeout": "1h",
    "distributed.admin.log-format": "%(message)s",
}


class DaskCluster:
    """Dask's workers by its own futures. Calls that wait at a worker may be lost with it."""

    name = "dask"
    names_the_dead = False

    def __init__(self, workers: int | None, address: str | None = None) -> None:
        """Without an `address` a cluster of so many workers is begun on this machine; of one that
        exists, `workers` None are as many as it has threads.

        Raises Unavailable if it can't be reached.
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

    def submit(self, call: Callable[[Any], Any], argument: Any) -> Any:
        return self._client.submit(call, argument, pure=False)

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

    def mend(self) -> None:
        """Dask's nannies begin new workers by themselves."""

    def close(self) -> None:
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()


def _require_scheduler(address: str) -> None:
    """Raises ArgoError if no scheduler answers at the address: a client would wait for ever."""
    require_listener(address, "Dask")

    async def asked() -> str:
        async with asyncio.timeout(_PATIENCE), rpc(address) as scheduler:
            return str((await scheduler.identity()).get("type"))

    try:
        # In a thread of its own: a notebook has a loop in this one.
        with ThreadPoolExecutor(1) as thread:
            kind = thread.submit(asyncio.run, asked()).result()
    except Exception as error:  # whatever else may be listening answers with
        why = "what listens there does not answer as one" if isinstance(error, OSError) else error
        raise Unavailable(f"no Dask cluster at {address}: {why}") from None
    if kind != "Scheduler":
        raise Unavailable(f"no Dask cluster at {address}: it is the address of a {kind}")
