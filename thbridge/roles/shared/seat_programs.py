"""Names of the programs of seats, in the text protocol and in recordings."""

from collections.abc import Iterable, Sequence

from thbridge.hunt.seats import ONE_SEAT, Seat, seat_named
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.router import RESEARCHER


def program_of(seat: str) -> str:
    """Return the name of the program of a seat."""
    return f"{legacy.TABUI}-{seat}" if seat else legacy.TABUI


def researchers_program(seat: str) -> str:
    """Return the name of the program with which a researcher plays a seat, while no participant does."""
    return f"{RESEARCHER}{seat}"


def is_researchers(program: str) -> bool:
    """Return True if a researcher plays a seat with this program."""
    return program.startswith(RESEARCHER)


def programs_of(seats: Iterable[str]) -> list[str]:
    """Return the names of the participants' programs, given the names of the seats; none means one participant."""
    return [program_of(seat) for seat in seats] or [legacy.TABUI]


def seat_name_of(program: str) -> str:
    """Return the name of a program's seat; empty if it has none, as in a game with one participant."""
    before, _, name = program.partition("-")
    return name if before == legacy.TABUI or is_researchers(program) else ""


def seat_of(program: str, seats: Sequence[Seat]) -> Seat | None:
    """Return the seat of a program; None if it has no seat. In a game without seats, each program has the one seat."""
    if not seats:
        return ONE_SEAT
    return seat_named(seats, seat_name_of(program))


def why_no_seat(program: str, seats: Sequence[Seat], extended: bool) -> str | None:
    """Return the reason, as a clause, why a program cannot have its name in a game, or None if it can.

    Only names of participants' programs are refused.

    Args:
        program: name of the program.
        seats: seats of the game.
        extended: False for a program of 2016.
    """
    before, hyphen, name = program.partition("-")
    if before != legacy.TABUI and not is_researchers(program):
        return None
    if not seats:
        is_for_seats = extended and hyphen
        return "this game has one participant and no seats; omit --seat" if is_for_seats else None
    if not extended:
        return "this game has several seats, which programs of 2016 cannot take"
    if seat_named(seats, name) is not None:
        return None
    problem = f"this game has no seat {name}" if name else "this game has several seats"
    return f"{problem}; use --seat with one of these names: {', '.join(seat.name for seat in seats)}"
