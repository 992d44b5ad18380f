"""Sentences on recordings of other versions and machines."""

import pytest

from thbridge.app.compose.machine import machine, versions
from thbridge.ros.messages.session_records import MACHINE, SessionRecord
from ui.commands.replay.difference import other_versions

HERE = versions() | machine()


def sentences(recorded: dict[str, str]) -> list[str]:
    return list(other_versions(SessionRecord("", 1, recorded, "play", (), "")))


def test_nothing_is_said_of_a_recording_of_this_machine() -> None:
    assert sentences(HERE) == []


def test_a_machine_is_told_by_every_name() -> None:
    assert tuple(machine()) == MACHINE
    assert all(machine().values())


def test_other_versions_are_named() -> None:
    assert sentences(HERE | {"numpy": "1.0"}) == [
        f"Recorded with other versions, which may change results: numpy 1.0 then, {HERE['numpy']} now."
    ]


@pytest.mark.parametrize(
    ("other", "told"),
    [
        ({"processor": "Z80"}, f"processor Z80 then, {HERE['processor']} now"),
        ({"processor features": "A20"}, "other processor features"),
        ({"libc": "musl 1", "compiler features": ""}, f"libc musl 1 then, {HERE['libc']} now; other compiler features"),
    ],
)
def test_another_machine_is_named(other: dict[str, str], told: str) -> None:
    (sentence,) = sentences(HERE | other)
    assert sentence.startswith(f"Recorded on another machine: {told}. ")


def test_recordings_from_before_all_machines_computed_the_same_are_told() -> None:
    (sentence,) = sentences(versions())
    assert sentence.startswith("Recorded by a version whose results depended on the machine")
