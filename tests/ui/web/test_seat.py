"""Seat of a person in a game."""

from tests.support.hunts.people_in_a_hunt import HuntOfPeople
from thbridge.files.language_texts import shipped_texts
from ui.sources.game import GameConnection
from ui.web.page.messages import ActDone, KeyPressed, PagePainted
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


def test_no_part_of_a_text_is_lost_when_the_page_loads_again() -> None:
    sent, again = list[dict[str, Json]](), list[dict[str, Json]]()
    hunt = HuntOfPeople()
    hunt.run()
    driver = hunt.people["driver"]
    seat = GameSeat(lambda report: GameConnection("127.0.0.1", 1, "token", report, None), shipped_texts())
    seat._model = driver.model
    seat.show_to(sent.append)
    seat.refresh()
    # The browser has received this page, but not painted it yet.
    number = sent[-1]["n"]
    assert isinstance(number, int)
    seat.receive(ActDone(number, 0.0, {"act": "WriteText", "text": "half a sen"}))
    seat.show_to(again.append)
    seat.refresh()
    assert again[-1]["p"]["v"]["people"]["draft"] == "half a sen"  # type: ignore[call-overload,index]
    seat.receive(ActDone(number, 1.0, {"act": "SayToPeopleAct", "to": "", "text": "half a sentence"}))
    driver.tabui.poll_player()
    hunt.run()
    assert [text for _, text in hunt.people["namer"].read] == ["half a sentence"]
    assert driver.panel.draft == ""
