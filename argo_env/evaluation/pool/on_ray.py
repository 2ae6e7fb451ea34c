"""Workers of a Ray cluster: one of this machine, or an existing one by its address."""

import logging
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from typing import Any

import ray
from ray.exceptions import GetTimeoutError, RayTaskError, WorkerCrashedError

from argo_compiler.base.errors import Unavailable
from argo_env.evaluation.pool.backend import WorkerDiedError, require_listener

_STORE = 100_000_000  # bytes that Ray shares between processes; specs and rows are small
_ANSWERS = 40.0  # s until a cluster has taken a client
_PATIENCE = 60.0  # s until a result that is ready is there


class RayCluster:
    """Ray's workers by its own futures. A worker that dies takes no other call along."""

    name = "ray"
    names_the_dead = True

    def __init__(self, workers: int | None, address: str | None = None) -> None:
        """Without an `address` a cluster of so many workers is begun on this machine; of one that
        exists, `workers` None are as many as it has processors.

        Raises Unavailable if it can't be reached.
        """
        os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        if address not in (None, "auto", "local"):
            _require_cluster(str(address))
        own: dict[str, Any] = {}
        if address is None:
            own = {
                "num_cpus": workers,
                "object_store_memory": _STORE,
                "include_dashboard": False,
            }
        try:
            ray.init(
                address=address or "local",
                log_to_driver=False,
                logging_level=logging.ERROR,
                ignore_reinit_error=False,
                **own,
            )
        except (ConnectionError, RuntimeError, ValueError) as error:
            where = f" at {address}" if address else ""
            raise Unavailable(f"no Ray cluster{where}: {error}") from None
        # What it would print of workers that died is what rows say.
        ray._private.worker._worker_logs_enabled = False
        self.workers = workers or max(1, int(ray.cluster_resources().get("CPU", 1)))
        self._remote: dict[Any, Any] = {}

    def submit(self, call: Callable[[Any], Any], argument: Any) -> Any:
        remote = self._remote.get(call)
        if remote is None:
            remote = self._remote[call] = ray.remote(max_retries=0, num_cpus=1)(call)
        return remote.remote(argument)

    def wait(self, calls: Sequence[Any]) -> Sequence[Any]:
        if not calls:
            return ()
        ready, _ = ray.wait(list(calls), num_returns=1)
        if len(calls) > 1:
            ready, _ = ray.wait(list(calls), num_returns=len(calls), timeout=0)
        return list(ready)

    def result(self, call: Any) -> Any:
        try:
            return ray.get(call, timeout=_PATIENCE)
        except WorkerCrashedError:
            raise WorkerDiedError("the worker process ended") from None
        except RayTaskError as error:
            raise error.cause if isinstance(error.cause, Exception) else error from None
        except GetTimeoutError:
            raise WorkerDiedError("its result was lost with a machine of the cluster") from None
        except ray.exceptions.RayError as error:  # a machine is gone, or out of memory
            raise WorkerDiedError(_first_line(error)) from None

    def mend(self) -> None:
        """Ray begins new workers by itself."""

    def close(self) -> None:
        ray.shutdown(wait_for_processes=True)


def _require_cluster(address: str) -> None:
    """Raises ArgoError if a cluster at the address takes no calls: asked in a process of its own,
    as Ray would go on for ever trying to reach one that does not answer."""
    require_listener(address, "Ray")
    asked = "import ray, sys; ray.init(sys.argv[1], log_to_driver=False, logging_level=40)"
    try:
        done = subprocess.run(
            (sys.executable, "-c", asked, address), capture_output=True, timeout=_ANSWERS
        )
    except subprocess.TimeoutExpired:
        raise Unavailable(
            f"no Ray cluster at {address}: what listens there does not answer as one"
        ) from None
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip()
        why = said.rpartition("\n")[2]
        if "InvalidAuthToken" in said:
            why = "it asks for a token: set RAY_AUTH_MODE=token and RAY_AUTH_TOKEN"
        raise Unavailable(f"no Ray cluster at {address}: {why}")


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]
