import pickle
from pathlib import Path

from thbridge.files.errors import BadFile


def test_the_message_says_where_what_and_what_to_do():
    fault = BadFile(Path("a/file"), "'ten' is not a number", "write digits", line=3, key="Points")
    assert str(fault) == "a/file, line 3, Points: 'ten' is not a number. Write digits."


def test_what_is_not_known_is_left_out():
    assert str(BadFile(Path("a"), "the file is missing.", "add it.")) == "a: the file is missing. Add it."


def test_it_travels_between_processes():
    fault = BadFile(Path("a"), "p", "r", line=1, key="k")
    again = pickle.loads(pickle.dumps(fault))
    assert (str(again), again.line) == (str(fault), 1)
