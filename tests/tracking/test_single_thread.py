"""The tracker's linear algebra runs on one thread, and the caller's threads come back."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from cubeling.tracking.single_thread import _thread_controller, on_one_thread


def blas_threads() -> set[int]:
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


class Solver:
    @on_one_thread
    def threads(self) -> set[int]:
        return blas_threads()

    @on_one_thread
    def fail(self) -> None:
        raise ValueError("no solution")


@pytest.fixture
def two_threads():
    """A program that has imported numpy first, and chosen two threads."""
    with threadpool_limits(2, user_api="blas"):
        _thread_controller.cache_clear()
        yield
    _thread_controller.cache_clear()


def test_one_thread_solves_and_the_others_come_back(two_threads) -> None:
    assert blas_threads() == {2}
    assert Solver().threads() == {1}
    assert blas_threads() == {2}
    with pytest.raises(ValueError, match="no solution"):
        Solver().fail()
    assert blas_threads() == {2}


def test_where_there_is_one_thread_nothing_is_limited() -> None:
    with threadpool_limits(1, user_api="blas"):
        _thread_controller.cache_clear()
        assert _thread_controller() is None
        assert Solver().threads() == {1}
    _thread_controller.cache_clear()
