"""Rates: spread over time, and each link's own."""

from collections import Counter
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.vehicle.telemetry.streams import OFF, Streams, ticks_of
from thbridge.mavlink.vehicle.telemetry.telemetry import default_streams
from thbridge.mavlink.wire.outgoing import LinkId

HERE, THERE = LinkId(1), LinkId(2)


@given(st.integers(1, 250), st.integers(1, 200), st.integers(1, 200), st.integers(0, 10_000))
def test_each_link_gets_each_message_at_its_own_interval(system, default, own, start):
    streams = Streams({30: default}, system)
    streams.change(HERE, 30, own)
    heard = {HERE: [], THERE: []}
    for tick in range(start, start + 1000):
        for due in streams.due(tick):
            for link, ticks in heard.items():
                if due.link == link or (due.link is None and link not in due.except_links):
                    ticks.append(tick)
    for link, every in ((HERE, own), (THERE, default)):
        gaps = {after - before for before, after in pairwise(heard[link])}
        assert gaps <= {every}
        assert len(heard[link]) >= 1000 // every


def test_fifty_vehicles_do_not_all_speak_at_once():
    vehicles = [Streams(default_streams(5.0, AutopilotIdentity.ARDUPILOT), system) for system in range(1, 51)]
    per_tick = Counter()
    for tick in range(50):
        per_tick[tick] = sum(1 for vehicle in vehicles for _ in vehicle.due(tick))
    assert max(per_tick.values()) < 2 * min(per_tick.values())


def test_a_rate_that_is_taken_back_is_the_default_again():
    streams = Streams({30: 10}, 1)
    streams.change(HERE, 30, OFF)
    assert streams.every(HERE, 30) == OFF
    streams.change(HERE, 30, None)
    assert streams.every(HERE, 30) == 10
    assert all(due.except_links == frozenset() for tick in range(50) for due in streams.due(tick))


def test_intervals_are_whole_ticks():
    assert [ticks_of(us) for us in (1, 20_000, 29_999, 200_000, 1_000_000)] == [1, 1, 1, 10, 50]
