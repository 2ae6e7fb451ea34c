"""Pools of worker processes that die or are shut down while they are used."""

import os

import pytest
from loky.process_executor import BrokenProcessPool

from argo_compiler.base.process_pool import ProcessPool


def test_a_broken_pool_that_another_user_has_shut_down_is_still_a_broken_pool() -> None:
    """Its users start the work again in a new pool; of a pool shut down they know nothing."""
    pool = ProcessPool(1)
    assert pool.submit(abs, -1).result(60) == 1
    with pytest.raises(BrokenProcessPool):
        pool.submit(os._exit, 1).result(60)
    pool.shutdown(wait=False)
    with pytest.raises(BrokenProcessPool):
        pool.submit(abs, -1)


def test_a_pool_shut_down_starts_nothing() -> None:
    pool = ProcessPool(1)
    pool.shutdown()
    with pytest.raises(RuntimeError, match="after shutdown"):
        pool.submit(abs, -1)
