"""TabUI: what is sent again is known by its number, and after a lost connection the view comes first."""

from msgspec import structs

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import ScriptedPlayer
from thbridge.roles.participant.tabui import NUMBER_PERIOD, REJOIN_PERIOD, RETRY_PERIOD, TabUI
from thbridge.roles.shared.notices import KEEPER
from thbridge.roles.shared.view import RefusalView, RequestSuggestion, SendRobot, StopRobot, View
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import Notice, encode_notice, parse_notice

UNSURE = RequestSuggestion(0)


def begun() -> tuple[TabUI, ScriptedPlayer]:
    """A participant's program that has its first view, and is not connected with anything from here on."""
    player = ScriptedPlayer()
    hunt = HuntWithoutSimulator(participant=(tabui := TabUI(player)))
    hunt.run(10)
    assert isinstance(tabui.view, View)
    return tabui, player


def numbers(said: list[TextMessage]) -> list[tuple[str, int | None]]:
    notices = [notice for message in said if isinstance(notice := parse_notice(message), Notice)]
    return [(notice.kind, notice.request) for notice in notices]


def test_a_request_keeps_its_number_until_the_player_has_it_no_more() -> None:
    tabui, player = begun()
    player.wish = (UNSURE,)
    tabui.poll_player()
    said = [tabui.step(tick, []) for tick in range(100, 101 + 2 * RETRY_PERIOD)]
    assert [heard for each in said for heard in numbers(each)] == [("Unsure", 1)] * 3
    player.wish = (StopRobot(1), UNSURE)
    tabui.poll_player()
    assert numbers(tabui.step(560, [])) == [("CallBack", 2), ("Unsure", 1)]
    player.wish = ()
    tabui.poll_player()
    tabui.step(561, [])
    player.wish = (UNSURE, SendRobot(0, 3))
    tabui.poll_player()
    said = tabui.step(562, [])
    assert numbers(said) == [("Unsure", 3)]
    assert len(said) == 2, "a line of 2016 has no number"


def test_a_request_that_was_refused_or_has_had_no_effect_for_long_gets_another_number() -> None:
    tabui, player = begun()
    player.wish = (UNSURE, StopRobot(1))
    tabui.poll_player()
    assert numbers(tabui.step(100, [])) == [("Unsure", 1), ("CallBack", 2)]
    assert tabui.view is not None
    refused = structs.replace(tabui.view, refusal=RefusalView(1, "CallBack", "not-under-way", "It stands."))
    assert numbers(tabui.step(101, [encode_notice(KEEPER, "TabUI", refused)])) == []
    assert numbers(tabui.step(100 + RETRY_PERIOD, [])) == [("Unsure", 1), ("CallBack", 3)]
    assert numbers(tabui.step(100 + NUMBER_PERIOD, [])) == [("Unsure", 4), ("CallBack", 3)]


def test_after_a_lost_connection_the_view_may_show_first_that_a_request_was_granted() -> None:
    tabui, player = begun()
    player.wish = (UNSURE,)
    tabui.poll_player()
    assert numbers(tabui.step(100, [])) == [("Unsure", 1)]
    tabui.connected()
    assert numbers(tabui.step(110, [])) == [("ParticipantReady", None)]
    said = [numbers(tabui.step(tick, [])) for tick in range(111, 111 + REJOIN_PERIOD)]
    assert said == [[]] * (REJOIN_PERIOD - 1) + [[("Unsure", 1)]]
