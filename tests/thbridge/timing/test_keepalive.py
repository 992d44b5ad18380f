"""Heartbeats of robots while their time is paused or slow."""

import pytest

from thbridge.timing.keepalive import KeepAlive
from thbridge.timing.pacer import Pacer


class Counted:
    """A session whose ticks the test counts."""

    def __init__(self) -> None:
        self.tick = 0
        self.beats = 0

    def keep_alive(self) -> None:
        self.beats += 1


@pytest.mark.parametrize(
    ("rate", "ticks", "beats"),
    [(1.0, 50, 0), (4.0, 200, 0), (0.9, 45, 0), (0.5, 25, 3), (1.0, 4, 3), (0.0, 4, 0)],
    ids=["on time", "faster", "a little slower", "slower", "the machine is too slow", "nobody asks for a pace"],
)
def test_a_second_with_too_few_ticks_is_made_up_for(rate: float, ticks: int, beats: int) -> None:
    session = Counted()
    keep_alive = KeepAlive(session, Pacer(rate))
    for _ in range(3):
        session.tick += ticks
        keep_alive.check()
    assert session.beats == beats


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_a_pause_is(rate: float) -> None:
    session, pacer = Counted(), Pacer(rate)
    keep_alive = KeepAlive(session, pacer)
    pacer.pause()
    keep_alive.check()
    keep_alive.check()
    assert session.beats == 2
    pacer.resume()
    session.tick += 50
    keep_alive.check()
    assert session.beats == 2
