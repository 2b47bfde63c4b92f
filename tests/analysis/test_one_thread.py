"""Linear algebra inside our calls runs on one thread, and the caller's setting comes back."""

from threadpoolctl import threadpool_info, threadpool_limits

import undula as un
from undula.analysis.one_thread import on_one_thread


def threads() -> set[int]:
    return {int(pool["num_threads"]) for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_a_call_has_one_thread_and_the_caller_has_two_again() -> None:
    seen = []

    @on_one_thread
    def work() -> None:
        seen.append(threads())

    un.spectrum(un.Filament(4, un.TipLoad(20.0)))  # loads what there is to load
    with threadpool_limits(limits=2, user_api="blas"):
        work()
        assert threads() == {2}
    assert seen == [{1}]
