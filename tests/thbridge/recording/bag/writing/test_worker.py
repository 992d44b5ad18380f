import threading
from collections.abc import Callable

import pytest

from tests.support.bags.inline_queue import InlineQueue
from thbridge.recording.bag.writing.worker import JobQueue, WorkerThread

LANES: list[Callable[[], JobQueue]] = [InlineQueue, lambda: WorkerThread("test")]
PATIENCE = 120.0


@pytest.mark.parametrize("lane", LANES)
def test_jobs_are_done_in_order_and_none_after_one_that_failed(lane: Callable[[], JobQueue]) -> None:
    worker, done = lane(), list[int]()
    failure = OSError("no more")

    def fail() -> None:
        raise failure

    worker.submit(lambda: done.append(1), 100)
    worker.submit(lambda: done.append(2))
    assert worker.wait(0, PATIENCE)
    worker.submit(fail)
    worker.submit(lambda: done.append(3), 100)
    assert worker.wait(0, PATIENCE)
    assert (worker.failure, worker.waiting, done) == (failure, 0, [1, 2])


def test_it_tells_how_far_it_is_behind() -> None:
    now, gate = [5.0], threading.Event()
    worker = WorkerThread("test", lambda: now[0])
    assert worker.oldest_wait() == 0.0
    worker.submit(lambda: bool(gate.wait(PATIENCE)) or None, 70)
    now[0] = 6.0
    worker.submit(lambda: None, 30)
    now[0] = 8.0
    assert (worker.oldest_wait(), worker.waiting) == (3.0, 100)
    assert worker.wait(100, 0.0)
    assert not worker.wait(99, 0.0)
    gate.set()
    assert worker.wait(0, PATIENCE)
    assert (worker.oldest_wait(), worker.waiting) == (0.0, 0)


def test_once_ended_it_finishes_what_it_has_in_hand_and_takes_nothing_more() -> None:
    gate, began, done = threading.Event(), threading.Event(), list[int]()
    worker = WorkerThread("test")

    def first() -> None:
        began.set()
        gate.wait(PATIENCE)
        done.append(1)

    worker.submit(first)
    worker.submit(lambda: done.append(2))
    assert began.wait(PATIENCE)
    worker.end()
    worker.submit(lambda: done.append(3))
    gate.set()
    assert worker.wait(0, PATIENCE)
    assert done == [1]
