"""Worker processes that hold the environments of a batch, several each, and step them."""

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

_PATIENCE = 10.0  # s that a worker has to end by itself

MakeEnv = Callable[[], gym.Env[Any, Any]]


class Workers(NonCopyable):
    """Processes that hold so many environments each, nearly the same number. Close it; else the
    processes end with this object."""

    def __init__(self, make: MakeEnv, count: int, processes: int) -> None:
        """`count` environments, each made by `make` in its process."""
        sizes = [count // processes + (k < count % processes) for k in range(processes)]
        self.shares = [slice(*ends) for ends in pairwise(accumulate(sizes, initial=0))]
        """which environments each process holds"""
        context = multiprocessing.get_context()
        self._pipes: list[Connection] = []
        self._processes: list[BaseProcess] = []
        self._asked = 0  # so that an answer nobody has waited for is told from the next one
        self._end = weakref.finalize(self, _end_all, os.getpid(), self._pipes, self._processes)
        try:
            for size in sizes:
                ours, theirs = context.Pipe()
                self._pipes.append(ours)
                process = context.Process(
                    target=_work, args=(make, size, theirs, ours), daemon=True
                )
                process.start()
                theirs.close()
                self._processes.append(process)
            self._hear()  # that all are made
        except BaseException:
            self.close()
            raise

    def ask(self, name: str, arguments: Sequence[tuple[Any, ...]]) -> list[Any]:
        """Calls a method of each share with its own arguments, and gives what each environment
        answered, in their order. What an environment raised is raised once all have answered, that
        of the first one; Unavailable, once all have ended, if a process has died."""
        if not self._end.alive:
            raise gym.error.ClosedEnvironmentError("the processes of this batch have ended")
        self._asked += 1
        for k, pipe in enumerate(self._pipes):
            try:
                pipe.send((self._asked, name, arguments[k]))
            except OSError:
                raise self._died(k) from None
        return self._hear()

    def close(self) -> None:
        """Ends the processes; their environments are closed."""
        self._end()

    def _hear(self) -> list[Any]:
        answers, errors = [], []
        for k, pipe in enumerate(self._pipes):
            try:
                asked, answer, error = pipe.recv()
                while asked != self._asked:
                    asked, answer, error = pipe.recv()
            except (EOFError, OSError):
                raise self._died(k) from None
            answers += answer
            errors += [error] if error is not None else []
        if errors:
            raise errors[0]
        return answers

    def _died(self, number: int) -> Unavailable:
        process, share = self._processes[number], self.shares[number]
        process.join(_PATIENCE)
        code = process.exitcode
        self.close()
        return Unavailable(
            f"the process of the environments {share.start} to {share.stop - 1} has died with exit "
            f"code {code}, and the batch is closed: make another one"
        )


class _Share(SyncVectorEnv[Any, Any]):
    """The environments of one process. Begins those anew that have ended, by Gymnasium's rules."""

    def __init__(self, make: MakeEnv, count: int) -> None:
        super().__init__([make] * count, copy=False, autoreset_mode=AutoresetMode.NEXT_STEP)

    def resets(self, seeds: list[int | None], options: dict[str, Any] | None) -> list[Any]:
        """Observation and info of each."""
        _, infos = self.reset(seed=seeds, options=options)
        return list(zip(self._env_obs, infos.values(), strict=True))

    def steps(self, actions: Any) -> list[Any]:
        """All that a step of each has given."""
        _, rewards, terminated, truncated, infos = self.step(actions)
        told = zip(rewards.tolist(), terminated.tolist(), truncated.tolist(), strict=True)
        return [
            (observation, *one, info)
            for observation, one, info in zip(self._env_obs, told, infos.values(), strict=True)
        ]

    def calls(self, name: str, arguments: list[tuple[Any, ...]], named: dict[str, Any]) -> Any:
        """What a method of each returns, called with its own arguments, or an attribute."""
        found = [env.get_wrapper_attr(name) for env in self.envs]
        return [
            one(*own, **named) if callable(one) else one
            for one, own in zip(found, arguments, strict=True)
        ]

    def sets(self, name: str, values: list[Any]) -> list[None]:
        """Sets an attribute of each."""
        self.set_attr(name, values)
        return [None] * self.num_envs

    def ended(self) -> list[bool]:
        """Whether each begins anew with the next step."""
        return [bool(one) for one in self._autoreset_envs]

    def continues(self, ended: list[bool]) -> list[None]:
        """Takes on what `ended` gave."""
        self._autoreset_envs[:] = ended
        return [None] * self.num_envs

    def _add_info(
        self, vector_infos: dict[str, Any], env_info: dict[str, Any], env_num: int
    ) -> dict[str, Any]:
        # One by one: they are put together where those of all processes are.
        return vector_infos | {str(env_num): env_info}


def _work(make: MakeEnv, count: int, pipe: Connection, other_end: Connection) -> None:
    """What a process does: answers until its pipe is closed."""
    # Who asks decides when it ends, also after Ctrl-C, which every process of a terminal gets.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    other_end.close()
    share: _Share | None = None
    try:
        try:
            share = _Share(make, count)
            pipe.send((0, [], None))
        except Exception as error:
            pipe.send((0, [], _portable(error)))
            return
        while True:
            asked, name, arguments = pipe.recv()
            try:
                answer = pickle.dumps((asked, getattr(share, name)(*arguments), None))
            except Exception as error:
                answer = pickle.dumps((asked, [], _portable(error)))
            pipe.send_bytes(answer)
    except (EOFError, OSError):  # nobody asks any more
        return
    finally:
        if share is not None:
            share.close()


def _portable(error: Exception) -> Exception:
    """The error as it can be sent, with a note on where it was raised."""
    trace = "".join(traceback.format_exception(error))
    try:
        sent: Exception = pickle.loads(pickle.dumps(error))
    except Exception:
        sent = RuntimeError(f"{type(error).__name__}: {error}")
    sent.add_note(f"It was raised in a worker process:\n{trace}")
    return sent


def _end_all(owner: int, pipes: list[Connection], processes: list[BaseProcess]) -> None:
    if os.getpid() != owner:
        return  # a process that was forked later has no part in them
    for pipe in pipes:
        pipe.close()
    for process in processes:
        process.join(_PATIENCE)
        if process.is_alive():
            process.terminate()
            process.join()
        process.close()
