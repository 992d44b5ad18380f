"""Queues between threads: in order, bounded in number and bytes, and with few pending calls."""

import threading

from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2graph.sockets.last_items import MOST_BYTES, CallThread, ClientShares, ClientThreads, LastItems


@given(st.integers(1, 4), st.lists(st.integers(0, 3) | st.none(), max_size=60))
def test_the_last_items_arrive_in_order(depth, steps):
    calls, arrived, model, expected = [], [], [], []
    queue = LastItems(depth, calls.append, arrived.append)
    for at, step in enumerate(steps):
        if step is None and calls:
            calls.pop(0)()
            expected += model[:1]
            del model[:1]
        elif step is not None:
            assert queue.push(at, step) is (len(model) < depth)
            model = [*model, at][-depth:]
        assert len(calls) == bool(model)
    while calls:
        calls.pop(0)()
    assert arrived == expected + model
    assert queue.dropped == sum(step is not None for step in steps) - len(arrived)


def test_bytes_are_bounded_and_calls_do_not_add_up():
    calls, arrived = [], []
    queue = LastItems(10, calls.append, arrived.append)
    for number in range(1000):
        queue.push(number, MOST_BYTES if number % 3 == 0 else 1)
    queue.push("last", MOST_BYTES)
    for call in calls:  # A call may add the next one.
        call()
    assert arrived == ["last"]
    assert len(calls) == 1


def test_full_queues_with_one_consumer_take_turns():
    calls, arrived = [], []
    first, second = (LastItems(10, calls.append, arrived.append) for _ in range(2))
    for number in range(3):
        first.push(number, 1)
    second.push("other", 1)
    for call in calls:
        call()
    assert arrived == [0, "other", 1, 2]


def test_calls_are_made_in_order_after_the_start_and_a_fault_stops_none(caplog):
    thread, made = CallThread("calls"), []
    thread.post(lambda: made.append(1))
    thread.post(lambda: 1 / 0)
    assert made == []
    thread.start()
    thread.post(lambda: made.append(threading.current_thread().name))
    assert thread.end(60)
    assert made == [1, "calls"]
    assert "a call failed" in caplog.text


def test_a_call_that_never_returns_does_not_block_the_end():
    thread, blocked = CallThread("calls"), threading.Event()
    thread.start()
    thread.post(blocked.wait)
    assert not thread.end(0.01)
    blocked.set()


def test_a_client_for_which_a_call_waits_delays_no_other_client():
    threads, released, done, order = ClientThreads("test"), threading.Event(), threading.Event(), []
    threads.post("slow", released.wait, 0)
    for number in range(3):
        threads.post("slow", lambda number=number: order.append(number), 0)
    threads.post("other", lambda: order.append("other"), 0)
    threads.post("other", lambda: 1 / 0, 0)
    threads.post("other", done.set, 0)
    assert done.wait(10)
    assert order == ["other"]
    done.clear()
    released.set()
    threads.post("slow", done.set, 0)
    assert done.wait(10)
    assert order == ["other", 0, 1, 2]
    threads.end()
    assert threads.post("late", lambda: order.append("late"), 0)


def test_bytes_that_wait_for_clients_are_bounded():
    threads, released, done = ClientThreads("test"), threading.Event(), threading.Event()
    assert threads.post("a", released.wait, MOST_BYTES)
    assert not threads.post("b", done.set, 1)
    assert threads.post("c", done.set, 0)
    assert done.wait(10)
    released.set()
    threads.end()


def test_a_client_that_uses_its_share_leaves_the_rest_to_others():
    shares = ClientShares(256)
    assert [shares.take("flood", 1) for _ in range(65)] == [True] * 64 + [False]
    assert shares.take("other", 192)  # More than a quarter, if it is one thing.
    assert not shares.take("other", 1)
    assert not shares.take("third", 1)
    shares.give_back("flood", 1)
    assert shares.take("third", 1)


@given(st.lists(st.tuples(st.sampled_from("abcdef"), st.integers(1, 30)), max_size=200))
def test_shares_are_bounded_and_all_that_is_given_back_can_be_taken_again(steps):
    shares, taken = ClientShares(100), []
    for at, (client, amount) in enumerate(steps):
        if at % 3 == 2 and taken:
            shares.give_back(*taken.pop(0))
        elif shares.take(client, amount):
            taken.append((client, amount))
        assert sum(each for _, each in taken) <= 100
    for each in taken:
        shares.give_back(*each)
    assert shares.take("all", 100)
