import pytest

from ui.model.watching.bookmarks import NEAR, Bookmarks, clock, parse_clock


def test_a_bookmark_is_set_once_and_removed_where_it_is() -> None:
    bookmarks = Bookmarks([30.0, 10.0])
    assert bookmarks.toggle(20.0)
    assert bookmarks.times == (10.0, 20.0, 30.0)
    assert not bookmarks.toggle(20.0 + NEAR / 2.0)
    assert bookmarks.times == (10.0, 30.0)


def test_a_loop_goes_between_the_bookmarks_around_a_time() -> None:
    assert Bookmarks().around(5.0) is None
    assert Bookmarks([10.0]).around(10.0) is None
    bookmarks = Bookmarks([10.0, 20.0, 30.0])
    spans = [bookmarks.around(time) for time in (0.0, 10.0, 19.0, 20.0, 99.0)]
    assert spans == [(10.0, 20.0), (10.0, 20.0), (10.0, 20.0), (20.0, 30.0), (20.0, 30.0)]


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("83.4", 83.4), ("1:23.4", 83.4), (" 0:01:23,4 ", 83.4), ("90:00", 5400.0), (".5", 0.5), (clock(83.4), 83.4)],
)
def test_times_are_read_as_people_type_them(text: str, seconds: float) -> None:
    assert parse_clock(text) == pytest.approx(seconds)


@pytest.mark.parametrize("text", ["", "soon", "-1", "1:", ":", ".", "1:2:3:4", "1e3", "nan", "1.2.3", "1.5:00"])
def test_what_is_no_time_is_none(text: str) -> None:
    assert parse_clock(text) is None
