from hypothesis import given
from hypothesis import strategies as st

from thbridge.watching.sockets.backlog import Backlog

PUTS = st.lists(st.tuples(st.integers(0, 4), st.integers(1, 40)), max_size=60)
LATCHED = {0, 1}


def put_all(backlog: Backlog, puts: list[tuple[int, int]]) -> list[tuple[int, bytes]]:
    """Records that can be told apart, put one after the other."""
    records = [(channel, bytes([number]) * size) for number, (channel, size) in enumerate(puts)]
    for channel, record in records:
        backlog.put(channel, record, latched=channel in LATCHED)
    return records


@given(PUTS)
def test_what_fits_comes_out_as_it_went_in(puts):
    backlog = Backlog(limit=60 * 40)
    records = put_all(backlog, puts)
    taken = []
    while piece := backlog.take(50):
        taken += piece
    assert (taken, backlog.size, backlog.dropped) == (records, 0, 0)


@given(PUTS)
def test_what_does_not_fit_loses_whole_records_and_keeps_their_order(puts):
    backlog = Backlog(limit=100)
    records = put_all(backlog, puts)
    newest = {channel: record for channel, record in records if channel in LATCHED}
    assert backlog.size <= 100 + sum(map(len, newest.values()))
    taken = backlog.take(10_000)
    assert len(taken) + backlog.dropped == len(records)
    left = iter(records)
    assert all(record in left for record in taken)
    assert all((channel, record) in taken for channel, record in newest.items())


def test_the_heaviest_channel_loses_its_oldest():
    backlog = Backlog(limit=100)
    backlog.put(2, b"small", latched=False)
    for number in range(4):
        backlog.put(3, bytes([number]) * 30, latched=False)
    assert backlog.take(1000) == [(2, b"small"), (3, b"\2" * 30), (3, b"\3" * 30)]
    assert backlog.dropped == 2


def test_of_a_latched_channel_the_newest_stays_however_heavy_it_is():
    backlog = Backlog(limit=10)
    backlog.put(0, b"old" * 10, latched=True)
    backlog.put(0, b"new" * 10, latched=True)
    backlog.put(3, b"x" * 20, latched=False)
    assert backlog.take(1000) == [(0, b"new" * 10)]
    assert backlog.dropped == 2
