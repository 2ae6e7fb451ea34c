"""Worker processes that are forked from one that has loaded modules."""

import os
import signal
import threading
from multiprocessing import forkserver

import pytest

from argo_env.worker_processes import context_with


def parent_of_the_workers(context) -> int:
    """Return the process that the workers of a context are forked from."""
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_tell_parent, args=(sender,))
    process.start()
    parent = receiver.recv()
    process.join()
    return parent


def _tell_parent(sender) -> None:
    sender.send(os.getppid())


def test_a_process_begins_though_the_one_that_it_is_forked_from_is_killed_meanwhile():
    context = context_with("argo_env.worker_processes")
    before = parent_of_the_workers(context)
    assert before != os.getpid()
    os.kill(before, signal.SIGSTOP)  # a process that is begun now waits for it
    threading.Timer(0.3, os.kill, (before, signal.SIGKILL)).start()
    assert parent_of_the_workers(context) not in (before, os.getpid())


def test_a_process_that_can_not_begin_says_so(monkeypatch):
    def refuse(*_):
        raise ConnectionRefusedError

    monkeypatch.setattr(forkserver, "connect_to_new_process", refuse)
    with pytest.raises(OSError, match="forked from has ended"):
        parent_of_the_workers(context_with("argo_env.worker_processes"))
