"""The programs: a session or one role, kept to the clock, until it is over or somebody stops it."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from sim.observations import TICK, TICKS_PER_SECOND
from thbridge.adapters.ledger import Ledger
from thbridge.adapters.loop import run_ticks
from thbridge.adapters.recordings import journal_of
from thbridge.adapters.text_client import LossReason, Lost, TextClient
from thbridge.adapters.text_server import CannotListen, Listening, TextServer
from thbridge.app.compose import Setting
from thbridge.app.recording import BagWitness
from thbridge.app.session import Moment, Session, Witness
from thbridge.hunt.game import GameState
from thbridge.roles.hider import Hider
from thbridge.roles.keeper import Keeper
from thbridge.roles.role import Role
from thbridge.roles.simr import SimR
from thbridge.roles.tabui import TabUI
from thbridge.roles.view import View
from thbridge.wire import legacy
from thbridge.wire.client import Registered
from thbridge.wire.router import Forwarded, Router
from thbridge.wire.text import Message

_log = logging.getLogger(__name__)

LAST_WORDS = TICKS_PER_SECOND // 2
"""Ticks that a session goes on after the end of the game, so that everybody hears of it and the bag has it."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a hunt ended; what `thbridge play --json` prints.

    Attributes:
        seed: of the study.
        score: points.
        over: why the game ended (`hunt.events.EndReason`); None if it did not.
        rooms_visited: how many.
        identified: treasures named, rightly or wrongly.
        energy: what each robot has left.
        sim_seconds: simulated time from the start to the end of the game.
        wall_seconds: real time that took.
        collisions: times that a robot touched a wall or another robot.
        bag: the recording.
    """

    seed: int
    score: int
    over: str | None
    rooms_visited: int
    identified: int
    energy: tuple[float, ...]
    sim_seconds: float
    wall_seconds: float
    collisions: int
    bag: Path | None


class Unfinished(Exception):  # noqa: N818 - nothing went wrong with the program
    """The hunt ended before the game was over. Everything is closed in good order.

    Attributes:
        outcome: how things stood then.
        stopped: somebody stopped the program (Ctrl-C, SIGTERM); or else the time was up.
    """

    def __init__(self, outcome: Outcome, stopped: bool) -> None:
        super().__init__("stopped" if stopped else "the time was up")
        self.outcome = outcome
        self.stopped = stopped


@dataclass(frozen=True, slots=True)
class PlayOptions:
    """How a hunt is run, beside what the study says.

    Attributes:
        rate: simulated seconds per second; 0 as fast as it can.
        bag: where to record; None for no recording.
        outside: the roles that other programs will take, by name.
        max_seconds: simulated time after which an unfinished game is given up.
    """

    rate: float
    bag: Path | None
    outside: frozenset[str]
    max_seconds: float


async def play(
    setting: Setting,
    participant: TabUI,
    options: PlayOptions,
    ready: Callable[[Listening | CannotListen], None],
    progress: Callable[[Moment], None],
) -> Outcome:
    """Play one hunt with all roles in this process, but those left to others.

    Args:
        setting: the study.
        participant: whoever plays, unless that is left to an outside program.
        options: how.
        ready: told where others can join, or why they cannot.
        progress: told of every tick.

    Raises:
        BadFile: the journal or the bag cannot be written (as `BagNotWritten`).
        Unfinished: it was stopped, or the game was not over in time; what was recorded is complete.
    """
    study = setting.study
    roles: list[Role] = [setting.simr()]
    if legacy.HIDER not in options.outside:
        roles.append(setting.hider())
    if legacy.TABUI not in options.outside:
        roles.append(participant)
    ledger = Ledger(journal_of(options.bag)) if options.bag is not None else None
    recorder = setting.recorder(options.bag) if options.bag is not None else None
    try:
        router = Router()
        witnesses: list[Witness] = [] if recorder is None else [BagWitness(recorder)]
        session = Session(router, setting.keeper(), roles, ledger or _NoLog(), witnesses)
        server = TextServer(router, session.hear)
        session.perform = server.perform
        ending = Ending(options.max_seconds)

        def tick() -> bool:
            progress(session.step())
            return not ending.reached(session)

        ready(await server.start(study.server.host, study.server.port))
        try:
            run = await run_ticks(tick, _period(options.rate))
        finally:
            await server.stop()
    finally:
        if recorder is not None:
            recorder.close()
        if ledger is not None:
            ledger.close()
    outcome = _outcome(setting, session, ending, roles, run.seconds, options.bag)
    if ending.tick is None:
        raise Unfinished(outcome, stopped=not run.finished)
    return outcome


def _period(rate: float) -> float:
    """Seconds of wall time for a tick; 0 for a rate of 0, as fast as it can."""
    return TICK / rate if rate > 0.0 else 0.0


class _NoLog:
    """For a session that is not recorded at all."""

    def append(self, events: Sequence[object]) -> None:
        """Forget them."""


class Ending:
    """Sees when a session is over.

    Args:
        max_seconds: simulated time after which an unfinished game is given up.
    """

    def __init__(self, max_seconds: float) -> None:
        self._last_tick = max_seconds * TICKS_PER_SECOND
        self.tick: int | None = None
        """The tick in which the game ended, None before."""

    def reached(self, session: Session) -> bool:
        """Whether there is nothing more to do."""
        if self.tick is None and session.game is not None and session.game.ended is not None:
            self.tick = session.tick
        if self.tick is not None:
            return session.tick >= self.tick + LAST_WORDS
        return session.tick >= self._last_tick


def _outcome(
    setting: Setting, session: Session, ending: Ending, roles: Sequence[Role], wall: float, bag: Path | None
) -> Outcome:
    game = session.game
    snapshot = next(role.snapshot for role in roles if isinstance(role, SimR))
    ticks = session.tick if ending.tick is None else ending.tick
    return Outcome(
        seed=setting.study.seed,
        score=0 if game is None else game.score,
        over=None if game is None or game.ended is None else game.ended.reason.value,
        rooms_visited=_visited(game),
        identified=0 if game is None else sum(room.points is not None for room in game.rooms),
        energy=() if game is None else tuple(robot.energy for robot in game.robots),
        sim_seconds=round(ticks * TICK, 2),
        wall_seconds=round(wall, 2),
        collisions=0 if snapshot is None else int(snapshot.world.collisions.sum()),
        bag=bag,
    )


def _visited(game: GameState | None) -> int:
    return 0 if game is None else sum(room.visited for room in game.rooms)


async def serve(
    setting: Setting, ledger: Ledger, new_game: bool, ready: Callable[[Listening | CannotListen], None]
) -> None:
    """Run the text server and the keeper until stopped; a game that was cut off goes on.

    Args:
        setting: the study.
        ledger: the journals; closed at the end.
        new_game: leave an unfinished game as it is and begin the next.
        ready: told where the server is to be reached, or why not; in that case nothing else happens.

    Raises:
        BadFile: the journal cannot be read or written.
    """
    try:
        unfinished = None if new_game else ledger.resume()
        if unfinished is not None:
            _log.warning("going on with game %d (--new-game begins another)", ledger.last_game)
            if unfinished.torn:
                _log.warning("its last event was half written and is lost")
        last_game = ledger.last_game if unfinished is None else ledger.last_game - 1
        keeper: Keeper = setting.keeper(() if unfinished is None else unfinished.history, last_game)
        router = Router()
        session = Session(router, keeper, [], ledger)
        server = TextServer(router, session.hear)
        session.perform = server.perform
        listening = await server.start(setting.study.server.host, setting.study.server.port)
        ready(listening)
        if isinstance(listening, CannotListen):
            return

        def tick() -> bool:
            session.step()
            return True

        try:
            await run_ticks(tick, TICK)
        finally:
            await server.stop()
    finally:
        ledger.close()


async def take_part(
    role: Role,
    client: TextClient,
    rate: float,
    done: Callable[[Sequence[Message], Sequence[Message]], bool],
    lost: Callable[[Lost], None],
) -> bool:
    """Run one role against a server until it is done or stopped; it reconnects by itself.

    Args:
        role: the role.
        client: its connection, not running yet.
        rate: ticks run at this many times real time.
        done: asked after every tick, given what was heard and said in it.
        lost: told when the connection is lost, and why.

    Returns:
        Whether it is done; or else somebody stopped it.
    """
    ticks = count()

    def tick() -> bool:
        heard: list[Message] = []
        for event in client.take():
            match event:
                case Message():
                    heard.append(event)
                case Registered():
                    role.connected()
                case Lost():
                    lost(event)
        said = role.step(next(ticks), heard)
        for message in said:
            client.send(message)
        return not done(heard, said)

    async with client.running():
        run = await run_ticks(tick, _period(rate))
    return run.finished


async def simr(
    setting: Setting, host: str, port: int, token: str, rate: float, bag: Path | None, lost: Callable[[Lost], None]
) -> str | None:
    """Run the robots' program until stopped.

    Returns:
        Why the keeper does not want these robots, or None when stopped.

    Raises:
        BagNotWritten: the bag cannot be written; it is closed, and the program over.
    """
    role = setting.simr()
    recorder = setting.recorder(bag) if bag is not None else None
    witness = None if recorder is None else BagWitness(recorder)
    tick = 0

    def after(heard: Sequence[Message], said: Sequence[Message]) -> bool:
        nonlocal tick
        if witness is not None:
            passed = tuple(Forwarded(message, True, False) for message in (*heard, *said))
            witness.saw(Moment(tick, role.snapshot, passed, (), (), None))
        tick += 1
        return role.unfit is not None

    try:
        await take_part(role, TextClient(role.name, token, host, port), rate, after, lost)
    finally:
        if recorder is not None:
            recorder.close()
    return role.unfit


async def hider(role: Hider, host: str, port: int, token: str, lost: Callable[[Lost], None]) -> None:
    """Run the treasures' program until stopped."""
    await take_part(role, TextClient(role.name, token, host, port), 1.0, lambda heard, said: False, lost)


async def tabui(
    role: TabUI, host: str, port: int, token: str, lost: Callable[[Lost], None], shown: Callable[[View], None]
) -> View | None:
    """Run the participant's program until the game is over.

    Args:
        role: the participant.
        host: of the server.
        port: of the server.
        token: marks this run of the program.
        lost: told when the connection is lost, and why.
        shown: told of every new view.

    Returns:
        The last view, of a game that is over; None when stopped.
    """
    last: View | None = None

    def after(heard: Sequence[Message], said: Sequence[Message]) -> bool:
        nonlocal last
        if role.view is not None and role.view is not last:
            last = role.view
            shown(last)
        return last is not None and last.over is not None

    finished = await take_part(role, TextClient(role.name, token, host, port), 1.0, after, lost)
    return last if finished else None


def reason_of(lost: Lost) -> str:
    """Why there is no connection, for people."""
    if lost.reason is LossReason.REFUSED:
        return "another program holds this name at the server; waiting until it is free"
    return f"{lost.reason.value}; trying again" + (f" ({lost.detail})" if lost.detail else "")
