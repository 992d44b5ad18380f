"""A sender that sends too much waits longer and loses its own datagrams; others do not notice it."""

from collections.abc import Mapping

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2graph.sockets.fair_queue import BURST_NS, MOST_BYTES, MOST_SENDERS, SHARE, FairQueue, Sender

MS = 1_000_000
SECOND_NS = 1_000 * MS
QUIET = ("192.0.2.1", 1)
FLEET = ("192.0.2.2", 2)


def flooder(number: int) -> Sender:
    return "192.0.2.3", number


class Program:
    """Program that processes datagrams, with a clock of its own. Each sender's datagrams have a certain cost."""

    def __init__(self, costs_ns: Mapping[Sender, int], size: int = 60_000) -> None:
        self.queue = FairQueue()
        self.now_ns = 0
        self.used_ns = dict.fromkeys(costs_ns, 0)
        self._costs_ns = costs_ns
        self._content = bytes(size)

    def send(self, sender: Sender, count: int = 1) -> None:
        for _ in range(count):
            self.queue.add(sender, self._content)

    def run(self, until_ns: int) -> None:
        """Process what there is time for, and let the time pass."""
        while self.now_ns < until_ns:
            self.queue.advance(self.now_ns)
            taken = self.queue.take()
            if taken is None:
                self.now_ns += MS
                continue
            cost_ns = self._costs_ns[taken.turn]
            self.queue.spend(taken.turn, cost_ns)
            self.used_ns[taken.turn] += cost_ns
            self.now_ns += cost_ns


@given(st.integers(1, 4), st.integers(MS // 10, 15 * MS), st.integers(0, 50))
def test_a_quiet_sender_waits_for_a_turn_of_each_flooder_at_most(floods: int, cost_ns: int, start: int) -> None:
    costs_ns = {QUIET: MS // 10, **{flooder(number): cost_ns for number in range(floods)}}
    program = Program(costs_ns)
    for number in range(start, start + 20):
        for each in range(floods):
            program.send(flooder(each), 100)
        program.send(QUIET)
        asked_ns, before_ns = program.now_ns, program.used_ns[QUIET]
        while program.used_ns[QUIET] == before_ns:
            program.run(program.now_ns + 1)
        # Before its own datagram: one that has already used up the time, and a turn of each flooder.
        work_ns = cost_ns + floods * (MS + cost_ns) + costs_ns[QUIET]
        assert program.now_ns - asked_ns <= work_ns / SHARE + 2 * MS
        program.run(100 * MS * (number - start + 1))


@given(st.floats(0.05, 0.9 * SHARE))
def test_a_single_sender_gets_the_time_that_others_do_not_need(demand: float) -> None:
    program = Program({FLEET: MS})
    count = 0
    for now in range(1, 200):
        sent = int(now * 25 * demand) - count
        program.send(FLEET, sent)
        count += sent
        program.run(now * 25 * MS)
    program.run(6 * SECOND_NS)
    assert program.used_ns[FLEET] == count * MS


@pytest.mark.parametrize("floods", [1, 3, MOST_SENDERS + 10])
def test_floods_get_no_more_than_the_share_of_a_processor(floods: int) -> None:
    costs_ns = {flooder(number): MS for number in range(floods)}
    program = Program({**costs_ns, ("", 0): MS}, size=1000)
    for now in range(1, 101):
        for number in range(floods):
            program.send(flooder(number), 20 // floods + 1)
        program.run(now * 20 * MS)
    assert sum(program.used_ns.values()) <= SHARE * 2 * SECOND_NS + BURST_NS + MS


def test_a_busy_program_processes_what_waited_meanwhile() -> None:
    program = Program({FLEET: MS}, size=100)
    program.send(FLEET, 500)
    program.run(150 * MS)
    used_ns = program.used_ns[FLEET]
    program.now_ns += SECOND_NS
    program.run(program.now_ns + BURST_NS)
    assert program.used_ns[FLEET] - used_ns >= BURST_NS


@pytest.mark.parametrize("size", [500, 65_000])
def test_a_flood_displaces_only_its_own_datagrams(size: int) -> None:
    queue = FairQueue()
    for _ in range(50):
        assert queue.add(QUIET, bytes(100)) is None
    dropped = {queue.add(flooder(1), bytes(size)) for _ in range(2 * MOST_BYTES // size)}
    assert dropped == {None, flooder(1)[0]}
    assert queue.add(QUIET, bytes(100)) in dropped
    taken = []
    queue.advance(SECOND_NS)
    while (each := queue.take()) is not None:
        queue.spend(each.turn, 1)
        taken.append(each)
    assert sum(len(each.content) for each in taken) <= MOST_BYTES
    assert sum(each.turn == QUIET for each in taken) == 51


def test_senders_above_the_limit_share_the_turns_of_one() -> None:
    queue = FairQueue()
    for number in range(10 * MOST_SENDERS):
        assert queue.add(flooder(number), b"x") is None
    turns = set()
    while (each := queue.take()) is not None:
        queue.spend(each.turn, 1)
        assert each.host == flooder(0)[0]
        turns.add(each.turn)
    assert len(turns) == MOST_SENDERS + 1
