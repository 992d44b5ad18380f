from ui.model.watching.playback import Playback

SECOND = 1_000_000_000


def test_time_goes_on_only_while_it_plays() -> None:
    playback = Playback(0, 100 * SECOND)
    assert playback.advance(5.0) == 0
    playback.play(5.0)
    assert playback.advance(7.5) == round(2.5 * SECOND)
    playback.play(8.0, on=False)
    assert playback.advance(20.0) == 3 * SECOND


def test_speed_counts_from_when_it_is_set() -> None:
    playback = Playback(0, 100 * SECOND)
    playback.play(0.0)
    playback.set_speed(2.0, 10.0)
    assert playback.advance(3.0) == 12 * SECOND


def test_it_stops_at_the_end_and_begins_again_from_there() -> None:
    playback = Playback(SECOND, 2 * SECOND)
    playback.play(0.0)
    assert playback.advance(50.0) == 2 * SECOND
    assert not playback.playing
    playback.play(60.0)
    assert (playback.at_ns, playback.playing) == (SECOND, True)


def test_seeking_stays_within_the_recording() -> None:
    playback = Playback(SECOND, 2 * SECOND)
    playback.seek(0)
    assert playback.at_ns == SECOND
    playback.seek(9 * SECOND)
    assert playback.at_ns == 2 * SECOND


def test_a_loop_is_played_again_and_again() -> None:
    playback = Playback(0, 100 * SECOND)
    playback.loop = (10 * SECOND, 14 * SECOND)
    playback.seek(13 * SECOND)
    playback.play(0.0)
    assert playback.advance(0.5) == round(13.5 * SECOND)
    assert playback.advance(2.0) == 11 * SECOND
    assert playback.advance(50.0) == 11 * SECOND
    assert playback.playing
