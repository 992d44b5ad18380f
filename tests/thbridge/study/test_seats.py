"""Faults of seats in a study file: each has the key and a remedy."""

from pathlib import Path

import pytest

from thbridge.files.errors import BadFile
from thbridge.study.study_file import read_study_text

IDLE = "{name: idle, takes_over: false, names_treasures: false, stops: none}"
NAMER = "{name: namer, takes_over: false}"
TIMES = "team: {talk: {opens: 30, closes: 20}}"


@pytest.mark.parametrize(
    ("driver", "other", "team", "key", "problem", "remedy"),
    [
        ("robots: [1]", NAMER, "", "seats", "no seat commands robot 2", "Write each robot"),
        (
            "",
            "{name: idle, takes_over: false, names_treasures: false, stops: none}",
            "",
            "seats[1]",
            "nothing",
            "`robots`",
        ),
        ("", "{name: namer, takes_over: false, talks: false}", "", "seats", "agrees to a name", "`talks: true`"),
        ("ends_game: false", "{name: namer, ends_game: false}", "", "seats", "never ends", "`ends_game: true`"),
        ("", NAMER, TIMES, "team.talk.closes", "begin only at 30 s", "a later time"),
    ],
)
def test_what_no_seat_can_ever_do_is_a_fault(
    driver: str, other: str, team: str, key: str, problem: str, remedy: str
) -> None:
    rights = driver if "robots" in driver else f"robots: [1, 2], {driver}".rstrip(", ")
    seats = f"[{{name: driver, names_treasures: false, {rights}}}, {other}]"
    with pytest.raises(BadFile) as refused:
        read_study_text(Path("study.yaml"), f"robots: 2\nseats: {seats}\n{team}\n")
    assert refused.value.key == key
    assert problem in refused.value.problem and remedy in refused.value.remedy


SEATS = "seats:\n  - {name: driver, robots: [1]}\n"
CRITIC = "  - {name: critic, takes_over: false, names_treasures: false, objects: true"


def test_the_right_to_object_without_dialogues_to_read_is_a_fault() -> None:
    with pytest.raises(BadFile) as caught:
        read_study_text(Path("study.yaml"), f"robots: 1\n{SEATS}{CRITIC}, sees_dialogues: own}}\n")
    assert str(caught.value) == (
        "study.yaml, line 4, seats[1].objects: critic sees no dialogue of another seat, so it cannot object. "
        "Write `sees_dialogues: all`, or delete `objects`."
    )


def test_a_seat_that_only_objects_can_do_something() -> None:
    study = read_study_text(Path("study.yaml"), f"robots: 1\n{SEATS}{CRITIC}}}\n")
    assert [entry.seat().may_object for entry in study.seats] == [False, True]
