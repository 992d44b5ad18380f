"""Course of a visitor to a study file: rules, consent, one game, thanks. A game may have several visitors."""

import asyncio
import hashlib
import secrets
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import GameTexts
from thbridge.study.seats import seats_of
from thbridge.study.study_file import Study
from thbridge.timing.wall_clock import utc_now
from ui.command_line.settings import setting_of
from ui.hosting.games import offer_of
from ui.hosting.kiosk.words import headed
from ui.model.kiosk import (
    ConsentReply,
    ConsentToAsk,
    FromKiosk,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    StudyTexts,
    TextToRead,
    ToKiosk,
    TurnToAwait,
    WentOn,
)
from ui.model.playing.seat_words import seat_sentences
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.entry import LinkEntry
from ui.web.gateway.game_queue import LONGEST_WAIT, GameQueue
from ui.web.gateway.lobby import ServedLobby, WaitEnd, await_place
from ui.web.gateway.matching import MatchByArrival, MatchedGame
from ui.web.gateway.people import Visitor
from ui.web.gateway.waiting import pause, show_turn
from ui.web.pool.joined_game import JoinedGame
from ui.web.pool.messages import FromWorker, GamePassed, SeatDeclined, SeatWentOn
from ui.web.pool.pool import DeathCount, HostedGame, WorkerDied, WorkerPool
from ui.web.pool.running_games import GroupRecord
from ui.web.pool.single_game import SingleGame

MOST_ABSENCE = 300.0
"""Seconds without the browser of any person of a game after which the game ends."""
SHARED_GAME = "game-"
"""Prefix of the keys of games of several visitors."""
_DIGEST = 16


@dataclass(slots=True)
class ServedGame:
    """Game of a study file, of one visitor or several.

    Attributes:
        key: key of the game.
        request: the game.
        people: seat of each person who has not finished it, by the person's key.
        windows: browsers of these people, by their keys; those who have not come back since the server was started
            again have none.
        since: monotonic time from which this server serves the game.
    """

    key: str
    request: SingleGame
    people: dict[str, str]
    windows: dict[str, BrowserWindow] = field(default_factory=dict)
    since: float = field(default_factory=time.monotonic)

    @property
    def absence(self) -> float:
        """Seconds for which none of these people has been connected."""
        away = time.monotonic() - self.since
        return min((self.windows[each].absence if each in self.windows else away for each in self.people), default=away)

    @property
    def record(self) -> GroupRecord:
        """The people of the game, for the next server."""
        people = {seat: person for person, seat in self.people.items()}
        return GroupRecord(str(self.request.bag), people, {**self.request.consents})


class SingleGames:
    """Games of a study file: each visitor plays one, alone or with others.

    Args:
        study: the study.
        file: its file, for relative paths.
        pool: pool of workers.
        queue: queue of people who wait for a game.
        new_bag: function that returns the path of a new recording.
        max_seconds: simulated seconds after which a game is stopped.
        joined: game elsewhere, which one visitor after another joins. If None, each visitor has a new game.

    Attributes:
        texts: texts of the study's language.
    """

    def __init__(
        self,
        study: Study,
        file: Path | None,
        pool: WorkerPool,
        queue: GameQueue,
        new_bag: Callable[[], Path],
        max_seconds: float,
        joined: JoinedGame | None = None,
    ) -> None:
        self._study, self._file = study, file
        self._setting = setting_of(study, file)
        self.texts: Texts = self._setting.texts.in_browser()
        self._pool = pool
        self._queue = queue
        self._new_bag = new_bag
        self._max_seconds = max_seconds
        self._joined = joined
        self._games: dict[str, ServedGame] = {}
        # Times of consent of the people in the lobby.
        self._agreed: dict[str, str] = {}
        # Visitors wait for each other only if all seats are theirs.
        self._seats = {} if joined is not None else {seat.name: seat for seat in seats_of(study.seats)}
        matching = MatchByArrival(tuple(self._seats), lambda: f"{SHARED_GAME}{secrets.token_hex(_DIGEST // 2)}")
        self._lobby = ServedLobby(matching, self._begin_game, lambda: queue.spare)
        for key, group in pool.games.groups():
            self._add(key, self._request(Path(group.bag), group.consents), group.people)

    def window(self) -> BrowserWindow:
        """Return a window in the study's language."""
        return BrowserWindow(self.texts)

    def greet(self, secret: str, _entry: LinkEntry) -> ToKiosk | None:
        """Return the first page of a visitor; None if their game has begun."""
        return None if self._has_begun(_key(secret)) else self._consent() or self._rules(1)

    async def visit(self, visitor: Visitor) -> None:
        """Take a visitor through the course, or lead them back to their game."""
        window = visitor.window
        await window.send(StudyTexts(GameTexts.of(self.texts)))
        person, page, agreed_at = _key(visitor.secret), 1, ""
        has_begun = self._has_begun(person)
        if not has_begun:
            before = await self._prepare(window)
            if before is None:
                return
            page, agreed_at = before
        while page:
            if not has_begun:
                if not self._seats:
                    await self._await_turn(window, person, page)
                elif not await self._await_others(window, person, page, agreed_at):
                    return
                page += 1
            if not self._seats:
                request = self._joined or self._request(self._new_bag(), {"": agreed_at})
                self._add(person, request, dict.fromkeys(request.consents, person))
            page, has_begun = await self._play(window, self._games[person], person, page), False

    async def _prepare(self, window: BrowserWindow) -> tuple[int, str] | None:
        """Show rules and consent; return the number of the next page and the time of consent, or None if declined."""
        page, agreed_at = 1, ""
        if (consent := self._consent()) is not None:
            await window.send(consent)
            reply = await _about(window, page)
            while not isinstance(reply, ConsentReply):
                reply = await _about(window, page)
            if not reply.agrees:
                await window.send(self._not_taking_part())
                return None
            agreed_at = utc_now()
            page += 1
        await window.send(self._rules(page))
        while not isinstance(await _about(window, page), WentOn):
            pass
        return page + 1, agreed_at

    def _consent(self) -> ConsentToAsk | None:
        """Return the page that asks for consent; None if the study asks for none, or the server of the game asks."""
        if self._joined is not None:
            return None
        text = offer_of(self._setting, given=True).consent
        return ConsentToAsk(1, text) if text else None

    def _rules(self, page: int) -> TextToRead:
        """Return the page with the rules of the game."""
        texts, seat = self.texts, "" if self._joined is None else self._joined.seat
        offer = offer_of(self._setting, given=True, seat=seat)
        rules = "\n\n".join((texts.text("start.introduction"), *offer.rules))
        return TextToRead(page, texts.text("window.title"), rules, texts.text("start.begin", count=offer.usual))

    def _not_taking_part(self) -> TextToRead:
        return TextToRead(0, self.texts.text("pages.thanks"), self.texts.text("pages.not_taking_part"), "")

    def _has_begun(self, person: str) -> bool:
        if self._seats:
            return person in self._games
        return self._pool.games.is_running(person) or self._pool.games.result(person) is not None

    def _request(self, bag: Path, consents: Mapping[str, str]) -> SingleGame:
        return SingleGame(self._study, self._file, bag, False, consents, self._max_seconds)

    def _add(self, key: str, request: SingleGame, people: Mapping[str, str]) -> ServedGame:
        """Add a game with its people, by their seats."""
        game = ServedGame(key, request, {person: seat for seat, person in people.items()})
        self._games.update(dict.fromkeys(game.people, game))
        return game

    def _begin_game(self, matched: MatchedGame) -> None:
        """Add a game whose people were in the lobby."""
        consents = {seat: self._agreed.pop(person) for seat, person in matched.people.items()}
        game = self._add(matched.key, self._request(self._new_bag(), consents), matched.people)
        self._pool.games.keep_group(game.key, game.record)
        self._pool.reserve(game.key)

    def _finish(self, game: ServedGame, person: str) -> None:
        """Note that a person has finished their game; after the last one, delete its files."""
        del game.people[person], self._games[person]
        if game.people:
            self._pool.games.keep_group(game.key, game.record)
        else:
            self._pool.games.forget(game.key)

    async def _await_turn(self, window: BrowserWindow, key: str, page: int) -> None:
        """Let the visitor wait until their game can start."""
        texts, queue, waiting = self.texts, self._queue, True
        while waiting:
            queue.enter(key)
            try:
                waiting = not await self._show_turn(window, key, page)
            finally:
                queue.leave(key)
            if waiting:
                heading, text = headed(texts, "game_not_awaited", "web")
                await window.send(TextToRead(page, heading, text, texts.text("web.wait_again")))
                while not isinstance(await _about(window, page), WentOn):
                    pass
        if queue.is_closed:
            await pause(window, texts)

    async def _show_turn(self, window: BrowserWindow, key: str, page: int) -> bool:
        """Show the waiting page until the game can start; return False if the visitor stops waiting, or must."""
        queue, joined = self._queue, self._joined

        async def show(words: str, has_come: Callable[[], bool]) -> bool:
            return await show_turn(
                TurnToAwait(page, *headed(self.texts, words, "web")),
                window,
                lambda: _about(window, page),
                lambda: queue.is_closed or has_come(),
                lambda: queue.before(key),
                LONGEST_WAIT,
            )

        if joined is None:
            return await show("waiting_for_game", lambda: queue.admits(key))
        if not await show("game_taken", lambda: queue.admits(key)):
            return False
        if await joined.why_refused() is None:
            return True
        opening = asyncio.create_task(joined.opened())
        try:
            return await show("no_game", opening.done)
        finally:
            opening.cancel()

    async def _await_others(self, window: BrowserWindow, person: str, page: int, agreed_at: str) -> bool:
        """Let the visitor wait until a game with all its seats starts; return False after too long a wait."""
        texts = self.texts
        turn = TurnToAwait(page, *headed(texts, "waiting_for_others", "web"))

        async def show(has_come: Callable[[], bool]) -> bool:
            return await show_turn(turn, window, lambda: _about(window, page), has_come)

        while True:
            self._agreed[person] = agreed_at
            try:
                end, _ = await await_place(
                    self._lobby, person, lambda: window.is_connected, show, lambda: self._queue.is_closed
                )
            finally:
                self._agreed.pop(person, None)
            match end:
                case WaitEnd.PLACED:
                    return True
                case WaitEnd.CLOSED:
                    await pause(window, texts)
                case WaitEnd.UNMATCHED:
                    await window.send(TextToRead(0, *headed(texts, "no_others", "web"), ""))
                    return False
                case WaitEnd.STOPPED:
                    heading, text = headed(texts, "others_not_awaited", "web")
                    await window.send(TextToRead(page, heading, text, texts.text("web.wait_again")))
                    while not isinstance(await _about(window, page), WentOn):
                        pass

    async def _play(self, window: BrowserWindow, game: ServedGame, person: str, page: int) -> int:
        """Let a visitor play a game; return the number of the page after it, or 0 if they can play no other game."""
        texts, key, seat = self.texts, game.key, game.people[person]
        prepared = texts.text("pages.preparing", count=self._study.robots)
        if self._seats:
            own = self._seats[seat]
            prepared = f"{texts.text('web.others_found', seat=own.label)} {seat_sentences(texts, own)}"
        await window.send(GamePrepared(page, prepared))
        game.windows[person] = window
        went_on, declined, deaths = asyncio.Event(), asyncio.Event(), DeathCount()

        def news(message: FromWorker) -> None:
            match message:
                case SeatWentOn():
                    went_on.set()
                case SeatDeclined():
                    declined.set()
                case GamePassed(seconds):
                    deaths.reached = seconds
                case _:
                    pass

        while not deaths.are_too_many:
            try:
                if self._pool.games.result(key) is None:
                    await self._play_once(window, game, person, page + 1, news, went_on)
                break
            except WorkerDied:
                deaths.add()  # Another worker resumes the game.
        else:
            stopped = texts.text("kiosk.program_stopped")
            await window.send(TextToRead(0, stopped, texts.text("kiosk.cannot_go_on"), ""))
            return 0
        self._finish(game, person)
        if declined.is_set():
            await window.send(self._not_taking_part())
            return 0
        ended = texts.text("kiosk.game_ended")
        if not went_on.is_set():
            await window.send(GameRecorded(page + 2, ended, texts.text("kiosk.go_on_when_ready")))
            while not isinstance(await _about(window, page + 2), WentOn):
                pass
        thanks, played = texts.text("pages.thanks"), texts.text("web.played")
        if self._joined is None:
            await window.send(TextToRead(0, thanks, played, ""))
            return 0
        await window.send(TextToRead(page + 3, thanks, played, texts.text("game_over.again")))
        while not isinstance(await _about(window, page + 3), WentOn):
            pass
        return page + 4

    async def _play_once(
        self,
        window: BrowserWindow,
        game: ServedGame,
        person: str,
        page: int,
        news: Callable[[FromWorker], None],
        went_on: asyncio.Event,
    ) -> None:
        async with self._pool.enter(game.key, game.request, window.show, news, game.people[person]) as hosted:
            window.has_place = True
            window.play(hosted)
            await window.send(GameToJoin(page, "", 0, "", practice=False))
            watching = asyncio.create_task(_watch(game, hosted))
            ended = asyncio.create_task(hosted.ended())
            gone_on = asyncio.create_task(went_on.wait())
            try:
                await asyncio.wait((ended, gone_on), return_when=asyncio.FIRST_COMPLETED)
                # The others may play for longer. After the last person, the game ends at once.
                if len(game.people) == 1:
                    hosted.leave(everybody=True)
                    await ended
                elif ended.done():
                    await ended
            finally:
                for task in (watching, ended, gone_on):
                    task.cancel()
                window.play(None)
                window.has_place = False


def _key(secret: str) -> str:
    """Return the key of a visitor's game."""
    return f"visitor-{hashlib.sha256(secret.encode()).hexdigest()[:_DIGEST]}"


async def _watch(game: ServedGame, hosted: HostedGame) -> None:
    """End a game whose people do not come back."""
    while game.absence < MOST_ABSENCE:
        await asyncio.sleep(1.0)
    hosted.leave(everybody=True)


async def _about(window: BrowserWindow, page: int) -> FromKiosk:
    """Return the next message about a page."""
    while True:
        message = await window.next_request()
        if getattr(message, "page", page) == page:
            return message
