"""A participant that sends too much loses its own datagrams only."""

from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2graph.sockets.reading_shares import BURST_NS, SHARE, SHARE_OF_ALL, ReadingShares

MS = 1_000_000
SECOND_NS = 1_000 * MS


def used_ns(demands: dict[bytes, float], step_ns: int = 25 * MS, seconds: int = 10) -> dict[bytes, int]:
    """Return what participants use that need these fractions of a processor, in turns of one millisecond."""
    shares, used, waiting = ReadingShares(), dict.fromkeys(demands, 0), dict.fromkeys(demands, 0.0)
    for now in range(step_ns, seconds * SECOND_NS + 1, step_ns):
        shares.advance(now)
        waiting = {each: waiting[each] + demands[each] * step_ns for each in demands}
        while any(left >= MS for left in waiting.values()):
            for each, left in waiting.items():
                if left >= MS:
                    if shares.has_time(each):
                        shares.spend(each, MS)
                        used[each] += MS
                    waiting[each] -= MS
    return used


@given(st.sampled_from([5 * MS, 25 * MS, 100 * MS]))
def test_a_single_participant_loses_nothing_below_the_share_of_all(step_ns: int) -> None:
    assert used_ns({b"fleet": 0.3}, step_ns)[b"fleet"] == 3 * SECOND_NS


@given(st.floats(0.5, 4.0), st.integers(1, 3))
def test_floods_use_no_more_than_the_share_of_all_and_others_lose_nothing(flood: float, floods: int) -> None:
    loud = {bytes([number]): flood for number in range(floods)}
    used = used_ns({**loud, b"quiet": 0.8 * SHARE})
    assert used[b"quiet"] == 8 * SHARE * SECOND_NS
    assert sum(used.values()) <= (SHARE_OF_ALL + 2 * SHARE) * 10 * SECOND_NS + (floods + 2) * BURST_NS


def test_a_busy_program_reads_what_waited_meanwhile() -> None:
    shares = ReadingShares()
    for _ in range(100):
        shares.spend(b"fleet", MS)
    assert not shares.has_time(b"fleet")
    shares.advance(SECOND_NS)
    for _ in range(100):
        assert shares.has_time(b"fleet")
        shares.spend(b"fleet", MS)
    assert not shares.has_time(b"fleet")
