"""Seats of a study in the options of commands."""

from collections.abc import Collection
from pathlib import Path

from thbridge.hunt.seats import SEAT_NAME
from thbridge.roles.shared.seat_programs import program_of
from thbridge.study.study_file import Study
from ui.command_line.terminal import BAD_INPUT, fail, note


def person_seat(study: Study, file: Path | None, wanted: str | None, outside: Collection[str]) -> str:
    """Return the name of the seat that a person takes; empty in a game with one participant.

    If the person wants no particular seat, this is the first seat that no other program takes, and it is printed. A
    wrong option ends the program.

    Args:
        study: the study.
        file: file of the study, for messages.
        wanted: value of the option `--seat`.
        outside: names of the roles that other programs have.
    """
    if wanted is not None:
        known_seat(study, file, wanted)
        if program_of(wanted) in outside:
            fail(BAD_INPUT, f"--seat: --outside gives {wanted} to another program. Write {wanted} in one option only.")
        return wanted
    if not study.seats:
        return ""
    free = [each.name for each in study.seats if program_of(each.name) not in outside]
    if not free:
        fail(BAD_INPUT, "--outside: it gives all seats to other programs, so you have none. Omit one of them.")
    others = ", ".join(each.name for each in study.seats if each.name != free[0])
    note(f"You take the seat {free[0]}. To take another one ({others}), add --seat NAME.")
    return free[0]


def known_seat(study: Study, file: Path | None, name: str) -> None:
    """End the program if a study has no seat with this name."""
    source = "this study" if file is None else str(file)
    if not study.seats:
        fail(BAD_INPUT, f"--seat: {source} has no `seats`, so its game has one participant. Omit the option.")
    names = [each.name for each in study.seats]
    if name not in names:
        fail(BAD_INPUT, f"--seat: {name!r} is not in the `seats` of {source}. Write one of these: {', '.join(names)}.")


def client_seat(study: Study, file: Path | None, name: str | None) -> str:
    """Return the name of the seat of a program at a server; empty for a game with one participant.

    Without a study file, only the server knows the seats. It refuses wrong names.
    """
    if file is not None and study.seats and name is None:
        names = ", ".join(each.name for each in study.seats)
        fail(BAD_INPUT, f"--seat: the game of {file} has several seats. Add --seat with one of these: {names}.")
    if name is None:
        return ""
    if file is not None:
        known_seat(study, file, name)
    elif not SEAT_NAME.fullmatch(name):
        fail(BAD_INPUT, f"--seat: {name!r} is no name of a seat. Write a name of the server's study, such as driver.")
    return name
