"""Desk of the researcher in a browser: people, problems and games of a served study, and actions on them."""

import asyncio
import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Protocol

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from thbridge.credentials import Credentials, Right
from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor, unfinished
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.store.events import EventKind, JsonValue, LogEntry, RunState
from thbridge.files.errors import BadFile
from thbridge.sockets.keys import KeyVerifier
from thbridge.timing.wall_clock import utc_now
from ui.hosting.kiosk.study_actions import StudyActions
from ui.model.desk.messages import (
    DeskState,
    EndRun,
    ExcludeRun,
    FromDeskPage,
    MessagePeople,
    SetAdmission,
    WatchRun,
)
from ui.model.desk.state import ToldToDesk, desk_state
from ui.web.gateway.limits import ClientLimits
from ui.web.page.desk_page import DeskNow, DeskPage, DeskPageMaker, PersonNow
from ui.web.page.patches import Json, patch, tree

KEY_SECONDS = 10.0
"""Seconds within which a browser must send its key."""
WRONG_KEY_SECONDS = 1.0
"""Delay in seconds before the answer to a wrong key."""
LOOK_SECONDS = 1.0
"""Seconds between two looks at people and games."""
STATE_SECONDS = 2.0
"""Seconds between two computations of the study's state, which needs all events."""
RENEWED_SECONDS = 20.0
"""Seconds after which the state is computed again even without events, as it contains times in minutes."""
LONGEST = 2000
"""Maximum number of characters of a message or a reason."""
WRONG_KEY, GONE = 4401, 4000
"""Reasons for which the gateway closes the socket of a desk: a wrong key; the key is no longer valid."""


class DeskKey(msgspec.Struct, frozen=True, tag_field="t", tag="key"):
    """Browser: first message, with the researcher's key."""

    key: str


_KEY = msgspec.json.Decoder(DeskKey)
_REQUEST: msgspec.json.Decoder[FromDeskPage] = msgspec.json.Decoder(FromDeskPage)


class PeopleHere(Protocol):
    """People of a study whose browsers the gateway serves."""

    def people_now(self) -> Mapping[str, PersonNow]:
        """Return the browsers of people, by their ids."""

    async def show_message(self, participant: str, text: str) -> None:
        """Show a message of the researcher to a person."""

    def wake(self, participant: str) -> None:
        """Make the course of a person look at their run again."""

    def watch(self, participant: str) -> None:
        """Make the game of a person ready for `thbridge watch`."""


class ServedDesk:
    """Desk of a served study.

    Args:
        design: design of the study.
        conductor: conductor of the study.
        people: people whose browsers the gateway serves.
        games: function that returns the numbers of running games and of games that can still start.
        texts: texts of the study's language.
    """

    def __init__(
        self,
        design: ExperimentDesign,
        conductor: Conductor,
        people: PeopleHere,
        games: Callable[[], tuple[int, int]],
        texts: Texts,
    ) -> None:
        self._design = design
        self._entries: list[LogEntry] = list(conductor.entries)
        conductor.listeners.append(self._entries.append)
        self._known = -1
        self._conductor = conductor
        self._people = people
        self._games = games
        self.texts = texts
        self._maker = DeskPageMaker(texts)
        self._actions = StudyActions(conductor, texts, people.wake)
        self._problems: dict[str, None] = {}
        self._state = DeskState(design.file.title, 0, 0)
        self._computed = -math.inf
        self._computing = asyncio.Lock()

    def report(self, problem: str) -> None:
        """Receive a sentence about a problem; the latest 20 are shown."""
        self._problems.pop(problem, None)
        self._problems[problem] = None
        if len(self._problems) > 20:
            del self._problems[next(iter(self._problems))]

    async def page(self, told: str, *, may_act: bool) -> DeskPage:
        """Return the page now; `told` is the answer to the researcher's last request."""
        async with self._computing:
            age, length = time.monotonic() - self._computed, len(self._entries)
            if age >= RENEWED_SECONDS or (length != self._known and age >= STATE_SECONDS):
                progress, entries = self._conductor.progress, self._entries[:length]
                now = ToldToDesk(utc_now())
                self._state = await asyncio.to_thread(desk_state, self._design, progress, entries, now)
                self._computed, self._known = time.monotonic(), length
        state = msgspec.structs.replace(self._state, troubles=(*self._state.troubles, *self._problems))
        playing, free = self._games()
        admits = self._conductor.progress.admits
        return self._maker.page(state, DeskNow(self._people.people_now(), playing, free, admits, may_act, told))

    async def carry_out(self, request: FromDeskPage, author: str) -> str:
        """Carry out a request; return a sentence about the result, or an empty text if the page shows it."""
        self._computed = min(self._computed, time.monotonic() - STATE_SECONDS)
        try:
            match request:
                case ExcludeRun(participant, reason):
                    return self._checked(reason) or self._actions.exclude(participant, reason, author) or ""
                case EndRun(participant, reason):
                    return self._checked(reason) or self._actions.end_run(participant, reason, author) or ""
                case MessagePeople(text, participant):
                    return self._checked(text) or await self._message(text.strip(), participant, author)
                case SetAdmission(is_open):
                    if is_open != self._conductor.progress.admits:
                        self._conductor.set_admission(is_open, author)
                case WatchRun(participant):
                    self._people.watch(participant)
        except BadFile as bad:
            return str(bad)
        return ""

    def _checked(self, text: str) -> str:
        return "" if 0 < len(text.strip()) <= LONGEST else self._text("empty")

    async def _message(self, text: str, participant: str, author: str) -> str:
        runs = self._conductor.progress.runs
        if participant and (participant not in runs or runs[participant].state is not RunState.UNDER_WAY):
            return self._text("not_under_way", participant=participant)
        receivers = [participant] if participant else [run.participant for run in unfinished(self._conductor.progress)]
        for receiver in receivers:
            if other := self._actions.other_in(text, receiver):
                return self._text("names_other", participant=other)
        for receiver in receivers:
            data: dict[str, JsonValue] = {"text": text, "author": author}
            self._conductor.tell_of_run(EventKind.MESSAGE_SENT, receiver, data, "experimenter")
            await self._people.show_message(receiver, text)
        return self._text("sent", participants=", ".join(receivers)) if receivers else self._text("sent_to_nobody")

    def _text(self, key: str, **values: str) -> str:
        return self.texts.text(f"desk.{key}", count=None, **values)


class DeskSockets:
    """Sockets of the desk's browsers.

    Args:
        desk: the desk.
        keys: keys that admit researchers. A key needs the right to watch, and the right to intervene for actions.
        limits: limits of the gateway.
    """

    def __init__(self, desk: ServedDesk, keys: KeyVerifier, limits: ClientLimits) -> None:
        self._desk = desk
        self._keys = keys
        self._limits = limits

    async def serve(self, websocket: WebSocket, address: str) -> None:
        """Serve an accepted socket of a browser at this address until it is closed."""
        with suppress(WebSocketDisconnect, TimeoutError, RuntimeError):
            credentials = await self._admitted(websocket, address)
            if credentials is None:
                return
            session = _DeskSession(self._desk, websocket, credentials)
            tasks = asyncio.create_task(session.receive()), asyncio.create_task(session.show(self._keys))
            try:
                await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)
            await websocket.close(session.closing)

    async def _admitted(self, websocket: WebSocket, address: str) -> Credentials | None:
        """Return the credentials of the key that a browser sends first; refuse the browser if the key is wrong."""
        async with asyncio.timeout(KEY_SECONDS):
            message = await websocket.receive()
        refusal = "refused"
        if self._limits.failures.delay(address):
            self._limits.refusals.warn(f"{address} sends too many wrong keys to the researcher's page.")
            refusal = "too_often"
        else:
            with suppress(msgspec.MsgspecError, RecursionError):
                credentials = self._keys.identify(_KEY.decode(message.get("text") or "").key)
                if isinstance(credentials, Credentials) and credentials.may(Right.WATCH):
                    return credentials
            self._limits.failures.take(address)
            self._limits.refusals.warn(f"{address} sent a wrong key to the researcher's page.")
        await asyncio.sleep(WRONG_KEY_SECONDS)
        await websocket.send_json({"t": "refused", "text": self._desk.texts.text(f"desk.{refusal}")})
        await websocket.close(WRONG_KEY)
        return None


class _DeskSession:
    """Browser of one researcher.

    Attributes:
        closing: reason for which the socket is closed.
    """

    def __init__(self, desk: ServedDesk, websocket: WebSocket, credentials: Credentials) -> None:
        self._desk = desk
        self._websocket = websocket
        self._credentials = credentials
        self._may_act = credentials.may(Right.INTERVENE)
        self._author = credentials.key or desk.texts.text("desk.researcher")
        self._told = ""
        self._news = asyncio.Event()
        self.closing = 1000

    async def receive(self) -> None:
        """Carry out the requests of the researcher until the socket is closed."""
        while True:
            message = await self._websocket.receive()
            if message["type"] == "websocket.disconnect":
                raise WebSocketDisconnect(message.get("code", 1000))
            try:
                request = _REQUEST.decode(message.get("text") or "")
            except (msgspec.MsgspecError, RecursionError):
                self.closing = 1008
                return
            if self._may_act:
                self._told = await self._desk.carry_out(request, self._author)
            else:
                self._told = self._desk.texts.text("desk.view_only")
            self._news.set()

    async def show(self, keys: KeyVerifier) -> None:
        """Send the page, and its differences, until the key is no longer valid."""
        shown: DeskPage | None = None
        while keys.why_not(self._credentials) is None:
            self._news.clear()
            page = await self._desk.page(self._told, may_act=self._may_act)
            difference: dict[str, Json] | None = {"v": tree(page)} if shown is None else patch(shown, page)
            if difference is not None:
                await self._websocket.send_text(msgspec.json.encode({"t": "page", "p": difference}).decode())
                shown = page
            with suppress(TimeoutError):
                async with asyncio.timeout(LOOK_SECONDS):
                    await self._news.wait()
        self.closing = WRONG_KEY
