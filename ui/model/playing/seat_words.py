"""Sentences about a seat for its person: the robots that it commands, its rights, and what it does not see."""

from collections.abc import Sequence

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.seats import DialogueSight, Seat, StopRight
from ui.model.playing.seat_view import either


def seat_sentences(texts: Texts, seat: Seat, robots: Sequence[int] | None = None) -> str:
    """Return the sentences about a seat.

    Args:
        texts: texts of the person's language.
        seat: the seat.
        robots: indices of the robots that it commands; if None, those that it commands at the start.
    """
    commanded = seat.robots if robots is None else robots
    which = texts.listed(map(texts.robot, commanded)) if commanded else ""
    commands = texts.text("seats.you_command", which=which) if which else texts.text("seats.you_command_none")
    return " ".join((commands, *rights_sentences(texts, seat)))


def rights_sentences(texts: Texts, seat: Seat) -> tuple[str, ...]:
    """Return what a seat may and may not do, and what it does not see, as up to three sentences."""
    may = {
        "people.may_name": seat.names_treasures,
        "people.may_take_over": seat.can_take_over,
        "people.may_end": seat.ends_game,
    }
    done = [key for key, has in may.items() if has] + ["people.may_stop"] * (seat.stops is StopRight.ALL)
    done += ["people.may_object"] * seat.may_object
    not_done = [key for key, has in may.items() if not has] + ["seats.may_stop_any"] * (seat.stops is StopRight.NONE)
    unseen = {
        "seats.see_map": seat.sees_map,
        "seats.see_energy": seat.sees_energy,
        "seats.see_score": seat.sees_score,
        "seats.see_dialogues": seat.sees_dialogues is DialogueSight.ALL,
    }
    hidden = [texts.text(key) for key, sees in unseen.items() if not sees]
    sentences = []
    if done:
        sentences.append(texts.text("seats.you_may", what=texts.listed(map(texts.text, done))))
    if not_done:
        sentences.append(texts.text("seats.you_may_not", what=either(texts, [*map(texts.text, not_done)])))
    if hidden:
        sentences.append(texts.text("seats.you_do_not_see", what=either(texts, hidden)))
    return tuple(sentences)


def seat_in_common(seats: Sequence[Seat]) -> Seat:
    """Return a seat for sentences about all seats: it may do what any of them may, and sees what all of them see."""
    return Seat(
        "",
        "",
        names_treasures=any(seat.names_treasures for seat in seats),
        ends_game=any(seat.ends_game for seat in seats),
        sees_energy=all(seat.sees_energy for seat in seats),
        sees_score=all(seat.sees_score for seat in seats),
    )
