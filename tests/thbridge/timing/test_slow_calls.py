"""Calls that may take long: people are told, or they are left alone."""

import threading

import pytest

from thbridge.timing.slow_calls import ImpatientCaller, told_if_slow


def test_people_are_told_while_a_slow_block_goes_on() -> None:
    told = threading.Event()
    with told_if_slow(0.0, told.set):
        assert told.wait(60)


def test_of_a_call_that_never_ends_the_place_is_told_and_no_other_is_begun() -> None:
    release, begun = threading.Event(), []

    def never() -> int:
        begun.append(1)
        release.wait(60)
        return 1

    caller = ImpatientCaller[int](0.01)
    for _ in range(2):
        with pytest.raises(TimeoutError, match=r"no answer in 0.01 s; it is at \w+.py, line \d+"):
            caller.call(never)
    release.set()
    assert begun == [1]


def test_a_call_in_time_returns_or_raises_what_it_does() -> None:
    caller = ImpatientCaller[int](60.0)
    assert caller.call(lambda: 3) == 3
    with pytest.raises(ZeroDivisionError):
        caller.call(lambda: 1 // 0)
