import math

from thbridge.files.language_texts import shipped_texts
from ui.model.playing.memory.connection import ConnectionStatus

ENGLISH = shipped_texts()


def test_how_long_it_is_lost_is_told_each_second():
    link = ConnectionStatus()
    link.connected(0.0)
    assert link.trouble(ENGLISH, 0.5) is None
    link.lose("Nobody answers.", 10.0)
    assert link.trouble(ENGLISH, 10.2) == (
        "The connection to the game is lost. Nobody answers. Reconnecting… After that, you go on where you were."
    )
    assert link.next_change(10.2) == 11.0
    link.lose("Refused.", 11.0)
    assert link.trouble(ENGLISH, 11.0).startswith("The connection to the game has been lost for 1 second. Refused.")
    assert "for 2 seconds" in link.trouble(ENGLISH, 12.9)
    link.connected(13.0)
    assert link.trouble(ENGLISH, 13.1) is None


def test_before_there_ever_was_a_connection_none_is_lost():
    link = ConnectionStatus()
    link.lose("", 0.0)
    assert link.trouble(ENGLISH, 0.0) == "The game has not been reached yet. Reconnecting…"


def test_a_game_without_news_of_its_robots_stands_still():
    link = ConnectionStatus()
    link.connected(0.0)
    assert link.trouble(ENGLISH, 99.0) is None
    assert link.next_change(99.0) == math.inf
    link.receive(100.0)
    assert link.next_change(100.0) == 101.5
    assert link.trouble(ENGLISH, 101.4) is None
    assert (
        link.trouble(ENGLISH, 101.5)
        == "There is no news from the robots at the moment. The game goes on as soon as news arrives."
    )
    link.receive(102.0)
    assert link.trouble(ENGLISH, 102.0) is None
    link.lose("", 103.0)
    link.connected(110.0)
    assert link.trouble(ENGLISH, 110.5) is None
    assert link.trouble(ENGLISH, 111.5) is not None
