"""Worker processes that hold and step the environments of a batch, several each."""

import multiprocessing
import os
import pickle
import signal
import traceback
import weakref
from collections.abc import Callable, Sequence
from itertools import accumulate, pairwise
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

import gymnasium as gym
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from argo_compiler.base.errors import Unavailable
from argo_env.closing import NonCopyable

_PATIENCE = 10.0  # s within which a worker must end by itself

MakeEnv = Callable[[], gym.Env[Any, Any]]


class Workers(NonCopyable):
    """Worker processes with the environments of a batch, nearly the same number in each. Close it.

    Otherwise the processes end together with this object.
    """

    def __init__(self, make: MakeEnv, count: int, processes: int) -> None:
        """Start the processes, in which `make` creates `count` environments in all."""
        sizes = [count // processes + (k < count % processes) for k in range(processes)]
        self.slices = [slice(*ends) for ends in pairwise(accumulate(sizes, initial=0))]
        """environments of each process"""
        context = multiprocessing.get_context()
        self._pipes: list[Connection] = []
        self._processes: list[BaseProcess] = []
        # An answer that nobody has waited for is recognized by its request number.
        self._request_count = 0
        self._finalizer = weakref.finalize(
            self, _end_processes, os.getpid(), self._pipes, self._processes
        )
        try:
            for size in sizes:
                ours, theirs = context.Pipe()
                self._pipes.append(ours)  # type: ignore[arg-type, unused-ignore]
                process = context.Process(
                    target=_run_worker, args=(make, size, theirs, ours), daemon=True
                )
                process.start()
                theirs.close()
                self._processes.append(process)
            self._receive()  # wait until all environments are made
        except BaseException:
            self.close()
            raise

    def call_and_join_answers(
        self, name: str, process_arguments: Sequence[tuple[Any, ...]]
    ) -> list[Any]:
        """Call a method of `_WorkerEnvs` in each process, and return each environment's answer.

        `process_arguments` has the arguments for each process. The method returns a list with an
        answer for each of its environments; these lists are joined, in the order of the
        environments. If environments raise errors, the first one is raised after all processes have
        answered. If a process has died, all processes are ended and Unavailable is raised.
        """
        if not self._finalizer.alive:
            raise gym.error.ClosedEnvironmentError("the processes of this batch have ended")
        self._request_count += 1
        for k, pipe in enumerate(self._pipes):
            try:
                pipe.send((self._request_count, name, process_arguments[k]))
            except OSError:
                raise self._dead_worker_error(k) from None
        return self._receive()

    def close(self) -> None:
        """Close the environments and end the processes."""
        self._finalizer()

    def _receive(self) -> list[Any]:
        answers, errors = [], []
        for k, pipe in enumerate(self._pipes):
            try:
                request_number, answer, error = pipe.recv()
                while request_number != self._request_count:
                    request_number, answer, error = pipe.recv()
            except (EOFError, OSError):
                raise self._dead_worker_error(k) from None
            answers += answer
            errors += [error] if error is not None else []
        if errors:
            raise errors[0]
        return answers

    def _dead_worker_error(self, number: int) -> Unavailable:
        process, held = self._processes[number], self.slices[number]
        process.join(_PATIENCE)
        code = process.exitcode
        self.close()
        return Unavailable(
            f"the process of the environments {held.start} to {held.stop - 1} has died with exit "
            f"code {code}, and the batch is closed: make another one"
        )


class _WorkerEnvs(SyncVectorEnv[Any, Any]):
    """Environments of one process; by Gymnasium's rules, ended ones are reset by the next step."""

    def __init__(self, make: MakeEnv, count: int) -> None:
        super().__init__([make] * count, copy=False, autoreset_mode=AutoresetMode.NEXT_STEP)

    def reset_each(self, seeds: list[int | None], options: dict[str, Any] | None) -> list[Any]:
        """Reset the environments, and return observation and info of each."""
        _, infos = self.reset(seed=seeds, options=options)
        return list(zip(self._env_obs, infos.values(), strict=True))

    def step_each(self, actions: Any) -> list[Any]:
        """Step the environments, and return all that each step returns."""
        _, rewards, terminated, truncated, infos = self.step(actions)
        results = zip(rewards.tolist(), terminated.tolist(), truncated.tolist(), strict=True)
        return [
            (observation, *member, info)
            for observation, member, info in zip(
                self._env_obs, results, infos.values(), strict=True
            )
        ]

    def call_each(self, name: str, arguments: list[tuple[Any, ...]], named: dict[str, Any]) -> Any:
        """Call a method of each environment with its own arguments, or return an attribute."""
        members = [env.get_wrapper_attr(name) for env in self.envs]
        return [
            member(*own, **named) if callable(member) else member
            for member, own in zip(members, arguments, strict=True)
        ]

    def set_each(self, name: str, values: list[Any]) -> list[None]:
        """Set an attribute of each environment."""
        self.set_attr(name, values)
        return [None] * self.num_envs

    def ended_flags(self) -> list[bool]:
        """Return a flag for each environment: True if its episode is over, so a step resets it."""
        return [bool(member) for member in self._autoreset_envs]

    def set_ended_flags(self, ended: list[bool]) -> list[None]:
        """Restore the flags that `ended_flags` returned."""
        self._autoreset_envs[:] = ended
        return [None] * self.num_envs

    def _add_info(
        self, vector_infos: dict[str, Any], env_info: dict[str, Any], env_num: int
    ) -> dict[str, Any]:
        # They stay separate here: the batch merges those of all processes.
        return vector_infos | {str(env_num): env_info}


def _run_worker(make: MakeEnv, count: int, pipe: Connection, other_end: Connection) -> None:
    """Answer requests until the pipe is closed: the main function of a process."""
    # The parent decides when it ends, also after Ctrl-C, which all processes of a terminal get.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    other_end.close()
    envs: _WorkerEnvs | None = None
    try:
        try:
            envs = _WorkerEnvs(make, count)
            pipe.send((0, [], None))
        except Exception as error:
            pipe.send((0, [], _picklable_error(error)))
            return
        while True:
            request_number, name, arguments = pipe.recv()
            try:
                answer = pickle.dumps((request_number, getattr(envs, name)(*arguments), None))
            except Exception as error:
                answer = pickle.dumps((request_number, [], _picklable_error(error)))
            pipe.send_bytes(answer)
    except (EOFError, OSError):  # the parent has closed the pipe
        return
    finally:
        if envs is not None:
            envs.close()


def _picklable_error(error: Exception) -> Exception:
    """Return the error in a form that can be sent, with a note on where it was raised."""
    trace = "".join(traceback.format_exception(error))
    try:
        sent: Exception = pickle.loads(pickle.dumps(error))
    except Exception:
        sent = RuntimeError(f"{type(error).__name__}: {error}")
    sent.add_note(f"It was raised in a worker process:\n{trace}")
    return sent


def _end_processes(owner: int, pipes: list[Connection], processes: list[BaseProcess]) -> None:
    if os.getpid() != owner:
        return  # a process that was forked later does not own them
    for pipe in pipes:
        pipe.close()
    for process in processes:
        process.join(_PATIENCE)
        if process.is_alive():
            process.terminate()
            process.join()
        process.close()
