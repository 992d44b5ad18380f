"""One of the fields of cylinders of `tests/bench/robots/test_narrow_passages.py`, with twenty plans a second."""

from tests.support.robots.narrow_passages import drive, field_of, robot


def test_a_passage_hardly_wider_than_the_robot_is_driven_through():
    result = drive(field_of(6), robot(), 40.0)
    assert result.end == "reached", result
