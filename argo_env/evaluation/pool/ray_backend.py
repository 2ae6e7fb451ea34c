"""Back end with the workers of a Ray cluster, on this machine or at an address."""

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

_STORE_SIZE = 100_000_000  # bytes of Ray's shared memory; specs and rows are small
_CONNECT_TIMEOUT = 40.0  # s until a cluster has accepted a client
_RESULT_TIMEOUT = 60.0  # s until a result that is ready has been transferred


class RayBackend:
    """Back end with Ray's workers and futures; a dying worker loses its own call only."""

    name = "ray"
    isolates_deaths = True

    def __init__(self, workers: int | None, address: str | None = None) -> None:
        """Connect to the cluster at the address, or start one on this machine if it is None.

        `workers` None stands for one worker for each processor of an existing cluster or of this
        machine. Raises Unavailable if the cluster can't be reached or started.
        """
        os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        if address not in (None, "auto", "local"):
            _require_cluster(str(address))
        local_options: dict[str, Any] = {}
        if address is None:
            local_options = {
                "num_cpus": workers,
                "object_store_memory": _STORE_SIZE,
                "include_dashboard": False,
            }
        try:
            ray.init(
                address=address or "local",
                log_to_driver=False,
                logging_level=logging.ERROR,
                ignore_reinit_error=False,
                **local_options,
            )
        except (ConnectionError, RuntimeError, ValueError) as error:
            where = f" at {address}" if address else ""
            raise Unavailable(f"no Ray cluster{where}: {error}") from None
        # Ray would print messages about dead workers, which the rows report already.
        ray._private.worker._worker_logs_enabled = False
        self.workers = workers or max(1, int(ray.cluster_resources().get("CPU", 1)))
        self._functions: dict[Any, Any] = {}

    def submit(self, function: Callable[[Any], Any], argument: Any) -> Any:
        remote = self._functions.get(function)
        if remote is None:
            remote = self._functions[function] = ray.remote(max_retries=0, num_cpus=1)(function)
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
            return ray.get(call, timeout=_RESULT_TIMEOUT)
        except WorkerCrashedError:
            raise WorkerDiedError("the worker process ended") from None
        except RayTaskError as error:
            raise error.cause if isinstance(error.cause, Exception) else error from None
        except GetTimeoutError:
            raise WorkerDiedError("its result was lost with a machine of the cluster") from None
        except ray.exceptions.RayError as error:  # a machine was lost, or is out of memory
            raise WorkerDiedError(_first_line(error)) from None

    def replace_dead_workers(self) -> None:
        """Do nothing, as Ray starts new workers itself."""

    def close(self) -> None:
        ray.shutdown(wait_for_processes=True)


def _require_cluster(address: str) -> None:
    """Raise ArgoError if no Ray cluster accepts clients at the address.

    The check runs in a separate process, as Ray would try forever to reach a cluster that does not
    answer.
    """
    require_listener(address, "Ray")
    script = "import ray, sys; ray.init(sys.argv[1], log_to_driver=False, logging_level=40)"
    try:
        process = subprocess.run(
            (sys.executable, "-c", script, address), capture_output=True, timeout=_CONNECT_TIMEOUT
        )
    except subprocess.TimeoutExpired:
        raise Unavailable(
            f"no Ray cluster at {address}: the server there does not answer as one"
        ) from None
    if process.returncode:
        errors = process.stderr.decode(errors="replace").strip()
        why = errors.rpartition("\n")[2]
        if "InvalidAuthToken" in errors:
            why = "it requires a token: set RAY_AUTH_MODE=token and RAY_AUTH_TOKEN"
        raise Unavailable(f"no Ray cluster at {address}: {why}")


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]
