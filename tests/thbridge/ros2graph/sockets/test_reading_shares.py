"""A participant that sends too much loses its own datagrams only."""

from thbridge.ros2graph.sockets.reading_shares import BURST_NS, PER_TICK_NS, ReadingShares


def test_a_participant_that_used_its_time_waits_for_ticks_and_others_do_not() -> None:
    shares = ReadingShares()
    shares.spend(b"loud", BURST_NS - 1)
    assert shares.has_time(b"loud")
    shares.spend(b"loud", 2 * PER_TICK_NS + 1)
    assert not shares.has_time(b"loud")
    assert shares.has_time(b"quiet")
    shares.tick()
    shares.tick()
    assert not shares.has_time(b"loud")
    shares.tick()
    assert shares.has_time(b"loud")


def test_time_that_was_not_used_does_not_add_up() -> None:
    shares = ReadingShares()
    shares.spend(b"calm", 1)
    for _ in range(100):
        shares.tick()
    shares.spend(b"calm", BURST_NS)
    assert not shares.has_time(b"calm")
