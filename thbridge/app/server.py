"""Program with the text server and the keeper, which runs in real time until it is stopped."""

import logging
from collections.abc import Callable, Sequence

from thbridge.app.compose.game import build_keeper
from thbridge.app.compose.session import Programs, SessionRecording, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.app.session.session import SessionOutlets
from thbridge.app.trouble_log import TroubleLog
from thbridge.hunt.events import GameStarted, JournalEntry
from thbridge.recording.journal_folder import JournalStore
from thbridge.roles.keeper.disclosed.consent import CONSENT_SENTENCES, ConsentStatus
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.keys import RingKeys
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer

_log = logging.getLogger(__name__)


class ConsentedLog:
    """Event log of games, which writes events of a game only after recording of the participant is allowed.

    Args:
        journals: journals of the games.
        status: function that returns the state of consent after the step in which the appended events occurred.
    """

    def __init__(self, journals: JournalStore, status: Callable[[], ConsentStatus]) -> None:
        self._journals = journals
        self._status = status
        self._held: list[JournalEntry] = []
        self._open = False

    def append(self, entries: Sequence[JournalEntry]) -> None:
        """Write the entries or, before recording is allowed, store them. Call this method in every tick.

        Raises:
            BadFile: the journal cannot be written.
        """
        for entry in entries:
            if isinstance(entry, GameStarted):
                self._write()
                self._held, self._open = [], False
            self._held.append(entry)
        self._open = self._open or self._status().recordable
        self._write()

    def _write(self) -> None:
        if self._open:
            held, self._held = self._held, []
            self._journals.append(held)


async def serve(
    setting: StudySetting,
    journals: JournalStore,
    new_game: bool,
    ready: Callable[[ListeningAddress | CannotListen], None],
    keys: RingKeys | None = None,
    run: str = "",
) -> None:
    """Run the text server and the keeper until they are stopped. An interrupted game is resumed.

    Args:
        setting: the study.
        journals: journals of the games, which are closed at the end.
        new_game: True to begin a new game even if the last game is unfinished.
        ready: callback with the address of the server, or the reason why it cannot listen. After a reason, the function
            returns.
        keys: keys with which programs on other machines can take part; None if there are no keys.
        run: unique name for the folder of the journals, used if the folder has no name yet. The record of uses of keys
            contains the name.

    Raises:
        BadFile: the journal cannot be read or written.
    """
    try:
        unfinished = None if new_game else journals.resume()
        if unfinished is not None:
            _log.warning("resuming game %d (use --new-game to start a new game)", journals.last_game)
            if unfinished.torn:
                _log.warning("the last event of the game was not written completely and is lost")
        last_game = journals.last_game if unfinished is None else journals.last_game - 1
        history = () if unfinished is None else unfinished.history
        keeper = build_keeper(setting, history, last_game)
        for dialogue in keeper.dialogues_not_restored:
            _log.warning("dialogue %d cannot be resumed; the journal contains its sentences", dialogue)
        log = ConsentedLog(journals, lambda: keeper.consent)
        recording = SessionRecording(log=log, run="" if keys is None else journals.name_of_folder(run))
        server = TextServer(admission=Admission.to(setting.study.open_to), keys=keys)
        session = open_session(setting, Programs(), recording, SessionOutlets(server.perform), keeper)
        server.note_game(*session.game_name)
        listening = await server.start(session.router, setting.study.server.host, setting.study.server.port)
        ready(listening)
        if isinstance(listening, CannotListen):
            return

        reported = ConsentStatus.NOT_NEEDED
        troubles = TroubleLog()

        def tick() -> bool:
            nonlocal reported
            now = session.step()
            troubles.note(now.refusals, now.utterances)
            server.note_game(*session.game_name)
            before, reported = reported, keeper.consent
            if reported is not before and reported in CONSENT_SENTENCES:
                _log.warning(CONSENT_SENTENCES[reported])
            return True

        try:
            await run_ticks(tick, Pacer(1.0))
        finally:
            await server.stop()
    finally:
        journals.close()
