"""What a researcher's window was granted by a key is in the journal of the game that is played."""

import asyncio
from pathlib import Path

import pytest

from sim.inputs import ClearCostmaps
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import read_setting
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.app.session.inputs import ClientRequest
from thbridge.app.session.session import TickRecord
from thbridge.app.session.watch_requests import request_line
from thbridge.credentials import Right
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_file import read_key
from thbridge.files.keys.key_ring import KeyRing
from thbridge.hunt.events import KeyUsed
from thbridge.recording.journal_folder import JournalStore
from thbridge.recording.recordings import journal_of
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.keys import RingKeys
from thbridge.sockets.tls import server_context
from thbridge.study.study_file import BotStrategy, ServerSection, Study
from thbridge.watching.sockets.client import WatchClient

STUDY = Study(map="practice", templates="practice", robots=1, server=ServerSection(port=0))
NOW = "2026-03-01T12:00:00Z"


def test_the_journal_of_a_hunt_names_the_key_by_which_a_watcher_was_granted_a_request(tmp_path: Path) -> None:
    ring = KeyRing(tmp_path / "keys", lambda: NOW)
    key = read_key(ring.add("dora", [Right.INTERVENE], "secret of dora", "2026-03-02T12:00:00Z"))
    keys = RingKeys(ring, server_context(certificate_of(ring.folder, NOW)))
    setting, bag = read_setting(STUDY, tmp_path), tmp_path / "hunt.bag"
    begun = asked = False
    tasks: list[asyncio.Task[None]] = []

    def watched(where: ListeningAddress | CannotListen) -> None:
        assert isinstance(where, ListeningAddress)
        client = WatchClient(where.host, where.port, key)

        async def ask() -> None:
            while not begun or not client.send(request_line("somebody", ClearCostmaps(0))):
                await asyncio.sleep(0)

        tasks.extend(map(asyncio.ensure_future, (client.run(), ask())))

    def progress(now: TickRecord) -> None:
        nonlocal begun, asked
        begun = now.game is not None
        asked = asked or any(isinstance(item, ClientRequest) for item in now.inputs)

    async def whole() -> None:
        options = PlayOptions(
            50.0, bag, frozenset(), "suggestion", 600.0, left=lambda: asked, watch=WatchAddress("127.0.0.1", 0, keys)
        )
        player = TabUI(build_bot(setting.templates, BotStrategy.SUGGESTION, 1))
        told = StartupCallbacks(lambda master: None, watched)
        await play(setting, (player,), options, lambda where: None, progress, told)
        for task in tasks:
            task.cancel()

    with pytest.raises(HuntUnfinished):
        asyncio.run(whole())
    journal = JournalStore(journal_of(bag)).resume()
    assert journal is not None
    used = [entry for entry in journal.history if isinstance(entry, KeyUsed)]
    assert [(each.key, each.did.split()[:2]) for each in used] == [("dora", ["asked:", "ClearCostmaps"])]
