"""Tests of the pool on each of its back ends, all of them running on this machine."""

import errno
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from importlib.util import find_spec
from multiprocessing import get_context
from types import SimpleNamespace

import pytest

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable
from argo_env.evaluation.pool.backends import BACKENDS, make_backend
from argo_env.evaluation.pool.pool import Pool
from tests.argo_env.evaluation.conftest import PACKAGES
from tests.argo_env.evaluation.pool import work
from tests.processes import run_python


def execute(backend, function, arguments):
    """Return the completed calls of the function with each argument, by the argument's index."""
    pool = Pool(backend, function)
    for ticket, argument in enumerate(arguments):
        pool.submit(ticket, argument)
    calls = {}
    for call in pool.as_completed():
        assert call.ticket not in calls, "one call has completed twice"
        calls[call.ticket] = call
    return calls


def test_all_submitted_calls_complete_once(backend):
    calls = execute(backend, work.square, range(100))
    assert {ticket: call.value for ticket, call in calls.items()} == {k: k * k for k in range(100)}


def test_a_call_that_raises_does_not_affect_the_others(backend):
    calls = execute(backend, work.fail_on_seven, range(40))
    assert sorted(calls) == list(range(40))
    failed = {ticket: str(call.error) for ticket, call in calls.items() if call.error}
    assert failed == {k: f"no {k}" for k in (7, 17, 27, 37)}


def test_a_result_that_can_not_be_pickled_does_not_affect_the_others(backend):
    calls = execute(backend, work.not_sendable, range(200))
    assert sorted(calls) == list(range(200))
    by_pickle = {ticket for ticket, call in calls.items() if call.error}
    # Ray and Dask can send functions back.
    assert by_pickle in ({k for k in range(200) if k % 10 == 7}, set())
    assert all(call.value == k for k, call in calls.items() if k % 10 != 7)


@pytest.mark.long
def test_a_call_that_kills_its_worker_is_found_among_a_thousand(backend):
    calls = execute(backend, work.die_on_500, range(1_000))
    assert sorted(calls) == list(range(1_000))
    died = {ticket: call.died for ticket, call in calls.items() if call.died}
    assert list(died) == [500]
    assert "worker process" in died[500]
    assert all(call.value == ticket for ticket, call in calls.items() if ticket != 500)


def test_a_call_that_was_lost_with_its_worker_is_repeated(backend, tmp_path):
    calls = execute(backend, work.die_once, [(str(tmp_path), k) for k in range(20)])
    assert {ticket: call.value for ticket, call in calls.items()} == {k: k for k in range(20)}


@pytest.mark.long
def test_dying_workers_print_nothing_on_the_terminal(backend, capfd):
    calls = execute(backend, work.die_on_500, range(495, 505))
    assert calls[5].died
    time.sleep(1.0)  # for late output
    assert capfd.readouterr().out == ""


def test_more_may_be_submitted_meanwhile(backend):
    pool = Pool(backend, work.square)
    pool.submit(0, 0)
    values = []
    for call in pool.as_completed():
        values.append(call.value)
        if call.ticket < 30:
            pool.submit(call.ticket + 1, call.ticket + 1)
    assert values == [k * k for k in range(31)]


def test_all_workers_work(backend):
    workers = set()
    deadline = time.monotonic() + 120
    # A worker that another test has killed may still be starting.
    while len(workers) < 2 and time.monotonic() < deadline:
        workers |= {call.value for call in execute(backend, work.worker_id, range(60)).values()}
    assert len(workers) == 2


def test_there_is_a_test_for_each_back_end():
    assert set(PACKAGES) == set(BACKENDS)


def test_workers_that_can_not_start_raise_an_error():
    class Refused(get_context("spawn").Process):
        def start(self):
            raise ChildProcessError(errno.ECHILD, "too little memory")

    backend = make_backend(workers=1, context=SimpleNamespace(Process=Refused))
    with pytest.raises(Unavailable, match="no worker process can start: too little memory"):
        execute(backend, work.square, [1])
    backend.close()


def test_an_impossible_back_end_is_refused():
    with pytest.raises(Invalid, match="no back end `spark`; there are: processes, ray, dask"):
        make_backend("spark")
    with pytest.raises(Invalid, match="0 workers"):
        make_backend("processes", 0)
    with pytest.raises(Invalid, match="have no address"):
        make_backend("processes", 1, "127.0.0.1:1")


@pytest.mark.parametrize("name", ["ray", "dask"])
def test_a_back_end_that_is_not_installed_names_the_command_to_install_it(name, monkeypatch):
    monkeypatch.setattr(f"{make_backend.__module__}.find_spec", lambda _: None)
    with pytest.raises(ArgoError, match=r"pip install .*\[cluster\]"):
        make_backend(name)


@pytest.mark.long
@pytest.mark.skipif(find_spec("distributed") is None, reason="needs `distributed`")
def test_an_existing_dask_cluster_is_used_by_its_address(tmp_path):
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        dashboard_address="127.0.0.1:0",
        local_directory=tmp_path,
    ) as cluster:
        backend = make_backend("dask", address=cluster.scheduler_address)
        try:
            assert backend.workers == 2
            calls = execute(backend, work.square, range(10))
            assert [calls[k].value for k in range(10)] == [k * k for k in range(10)]
        finally:
            backend.close()


BY_ADDRESS = """
import sys
from argo_env.evaluation.pool.backends import make_backend
from tests.argo_env.evaluation.conftest import PACKAGES
from tests.argo_env.evaluation.pool import work
from tests.argo_env.evaluation.pool.test_pool import execute

backend = make_backend("ray", address=f"127.0.0.1:{sys.argv[1]}")
calls = execute(backend, work.square, range(10))
print(backend.workers, *(calls[k].value for k in range(10)))
backend.close()
"""


@pytest.mark.long
@pytest.mark.skipif(find_spec("ray") is None, reason="needs `ray`")
def test_an_existing_ray_cluster_is_used_by_its_address(monkeypatch):
    monkeypatch.setenv("RAY_AUTH_MODE", "disabled")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    command = (sys.executable, "-m", "ray.scripts.scripts", "start", "--head", "--block")
    options = ("--port", port, "--num-cpus", "2", "--include-dashboard=false")
    # A separate session ends with its own processes only; `ray stop` would also end all other Ray
    # clusters of this machine.
    head = subprocess.Popen((*command, *options, "--disable-usage-stats"), start_new_session=True)
    try:
        while not listens(int(port)):
            assert head.poll() is None, "the cluster has not started"
            time.sleep(0.1)
        # A separate process is needed, as a process can use one Ray cluster at a time.
        used = run_python("-c", BY_ADDRESS, port)
        assert used.stdout.split() == ["2", *(str(k * k) for k in range(10))]
    finally:
        head.terminate()
        head.wait(60)
        with suppress(ProcessLookupError):
            os.killpg(head.pid, signal.SIGKILL)


def listens(port: int) -> bool:
    with socket.socket() as client:
        return client.connect_ex(("127.0.0.1", port)) == 0


@pytest.mark.parametrize("name", ["ray", "dask"])
def test_a_missing_cluster_is_reported(name):
    pytest.importorskip(PACKAGES[name], reason=f"needs `{PACKAGES[name]}`")
    with pytest.raises(ArgoError, match=r"cluster at 127\.0\.0\.1:9: Connection refused"):
        make_backend(name, address="127.0.0.1:9")
    for nowhere in ("nonsense", "host:port", ""):
        with pytest.raises(ArgoError, match="give host:port"):
            make_backend(name, address=nowhere)


@pytest.mark.long
@pytest.mark.parametrize("name", ["ray", "dask"])
def test_a_server_that_is_no_cluster_is_not_waited_for(name, monkeypatch):
    module = pytest.importorskip(f"argo_env.evaluation.pool.{name}_backend")
    monkeypatch.setattr(module, "_CONNECT_TIMEOUT" if name == "ray" else "_SCHEDULER_TIMEOUT", 2.0)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        with pytest.raises(ArgoError, match="the server there does not answer as one"):
            make_backend(name, address=f"127.0.0.1:{port}")
