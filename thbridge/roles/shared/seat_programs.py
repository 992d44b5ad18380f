"""Names of the programs of seats, in the text protocol and in recordings."""

from collections.abc import Sequence

from thbridge.hunt.seats import ONE_SEAT, Seat, seat_named
from thbridge.text_protocol.wire import legacy


def program_of(seat: str) -> str:
    """Return the name of the program of a seat."""
    return f"{legacy.TABUI}-{seat}" if seat else legacy.TABUI


def seat_of(program: str, seats: Sequence[Seat]) -> Seat | None:
    """Return the seat of a program; None if it has no seat. In a game without seats, each program has the one seat."""
    if not seats:
        return ONE_SEAT
    before, _, name = program.partition("-")
    return seat_named(seats, name) if before == legacy.TABUI else None
