"""Seat of a person in a game."""

from thbridge.files.language_texts import shipped_texts
from ui.sources.game import GameConnection
from ui.web.page.messages import KeyPressed, PagePainted
from ui.web.page.patches import Json
from ui.web.seat import GameSeat


def test_the_age_of_a_view_is_the_time_from_its_sending_to_the_act() -> None:
    now, sent, acts = [10.0], list[dict[str, Json]](), list[tuple[str, float]]()
    seat = GameSeat(
        lambda report: GameConnection("127.0.0.1", 1, "token", report, None),
        shipped_texts(),
        acted=lambda act, view_age: acts.append((act, view_age)),
        clock=lambda: now[0],
    )
    seat.show_to(sent.append)
    seat.refresh()
    number = sent[-1]["n"]
    assert isinstance(number, int)
    now[0] = 10.25
    seat.receive(PagePainted(number, 5000.0))
    now[0] = 11.0
    seat.receive(KeyPressed(number, 5500.0, "F1"))
    assert acts == [("ShowHelp", 1000.0)]
