"""A researcher takes an empty seat of a running game from the researcher's window, until its person is there."""

import shutil
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from tests.support.hunts.recorded_hunts import watched_hunt
from tests.support.windows.desktop import x_server
from thbridge.hunt.codec import from_json
from thbridge.hunt.events import SeatTaken
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.watching.sockets.client import WatchClient
from ui.model.shared.theme import LIGHT
from ui.windows.link import ParticipantLink
from ui.windows.researcher.feeds.session import SessionFeed, WatchConnection
from ui.windows.researcher.window import ResearcherWindow

STUDY = """\
seats:
  - {name: driver, label: the driver, robots: [1, 2], names_treasures: false}
  - {name: namer, label: the namer}
"""
SECONDS = 60_000
"""Longest wait, milliseconds."""


@pytest.fixture
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Give the programs that this process starts a display."""
    with x_server(1600, 1000) as name:
        monkeypatch.setenv("DISPLAY", name)
        monkeypatch.setenv("QT_QPA_PLATFORM", "xcb")
        yield


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed (make peers, as root)")
@pytest.mark.usefixtures("display")
def test_a_researcher_plays_an_empty_seat_until_its_person_is_there(tmp_path: Path, qtbot: QtBot) -> None:
    study, bag = tmp_path / "study.yaml", tmp_path / "hunt.bag"
    study.write_text(STUDY)
    with watched_hunt(bag, str(study), "--outside", "TabUI-driver") as port:
        feed = SessionFeed(WatchConnection(WatchClient("127.0.0.1", port)), f"127.0.0.1:{port}")
        window = ResearcherWindow(feed, "session", LIGHT, time.monotonic)
        qtbot.addWidget(window)
        window.show()
        seats = window.seats
        qtbot.waitUntil(lambda: bool(seats.cards) and seats.cards[0].take.isEnabled(), timeout=SECONDS)
        assert seats.cards[0].accessibleName().startswith("The driver: not taken")
        assert seats.cards[1].accessibleName().startswith("The namer: program")
        seats.cards[0].take.click()
        assert window.statusBar().currentMessage().startswith("Opening the window of the seat driver")
        qtbot.waitUntil(lambda: "driver: researcher" in seats.cards[0].accessibleName(), timeout=SECONDS)
        assert feed.transport.status is not None
        host, _, number = feed.transport.status.game.rpartition(":")
        person = ParticipantLink(host, int(number), "person", seat="driver")
        person.start()
        qtbot.waitUntil(lambda: "driver: here" in seats.cards[0].accessibleName(), timeout=SECONDS)
        closed = "The window of the seat driver is closed: The server ended the connection: a person plays the seat"
        qtbot.waitUntil(lambda: window.statusBar().currentMessage().startswith(closed), timeout=SECONDS)
        person.stop()
        window.close()
    entries = (from_json(unpack.game_event(each.data).json) for each in messages(bag, [names.TEAM]))
    taken = [str(entry.by) for entry in entries if isinstance(entry, SeatTaken) and entry.seat == "driver"]
    assert taken == ["researcher", "person"]
