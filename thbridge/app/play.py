"""A complete hunt in one program, with all roles that other programs do not have, until the hunt is over or stopped."""

import logging
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack, closing
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app.compose.recording import build_publisher, build_record, build_recorder
from thbridge.app.compose.robots import build_team, rehearse
from thbridge.app.compose.session import SessionRecording, build_programs, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.app.consent import ConsentDesk, ParticipantDeclined, introductions
from thbridge.app.listeners import NO_CALLBACKS, StartupCallbacks, WatchAddress, listeners
from thbridge.app.run_statistics import RobotStatistics, RunStatistics
from thbridge.app.session.giving import give
from thbridge.app.session.input_log import InputLog, LoggedTick
from thbridge.app.session.inputs import ConnectionOpened, LinkOpened
from thbridge.app.session.recording import TlogRecorder
from thbridge.app.session.session import (
    DeferredRecording,
    EventLog,
    Session,
    SessionOutlets,
    TickRecord,
    TickRecorder,
)
from thbridge.app.trouble_log import TroubleLog
from thbridge.hunt.game import GameState
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.journal_folder import JournalStore
from thbridge.recording.recordings import journal_of, tlog_of
from thbridge.roles.keeper.disclosed.consent import CONSENT_SENTENCES, ConsentStatus
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.seat_programs import program_of, programs_of
from thbridge.ros.names import GRAPH_LINK
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.keys import RingKeys
from thbridge.text_protocol.sockets.server import RouterInterface, TextServer
from thbridge.timing.keepalive import kept_alive
from thbridge.timing.loop import LoopResult, run_ticks
from thbridge.timing.pace_meter import PaceMeter
from thbridge.timing.pacer import Pacer

if TYPE_CHECKING:
    from thbridge.mavlink.sockets.server import MavlinkPorts, MavlinkServer

_log = logging.getLogger(__name__)

PLAY = "play"
"""Name of this program in recordings."""

CHECKPOINT_TICKS = 20 * TICKS_PER_SECOND
"""Number of ticks between two checkpoints. The ticks since a checkpoint are run again in about two seconds."""

_PROMPT_TICKS = 4
"""Number of ticks that run on time after an input, so that the answer to it is sent at once."""

FINAL_TICKS = TICKS_PER_SECOND // 2
"""Number of ticks after the end of the game, in which all programs and the bag receive the last messages."""


@dataclass(frozen=True, slots=True)
class GameOutcome:
    """Result of one game of a hunt: the number of the game, and attributes as in `HuntOutcome`."""

    game: int
    score: int
    over: str | None
    rooms_visited: int
    identified: int
    energy: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class HuntOutcome:
    """Result of a hunt, which `thbridge play --json` prints.

    Attributes:
        seed: seed of the study.
        score: points.
        over: reason for the end (`hunt.events.EndReason`); None if the game did not end.
        rooms_visited: number of visited rooms.
        identified: number of named treasures; the names may be right or wrong.
        energy: remaining energy, by robot.
        sim_seconds: simulated time from the start to the end of the game, seconds.
        wall_seconds: real time from the start to the end of the game, seconds.
        collisions: number of times that a robot touched a wall or another robot.
        bag: path of the recording.
        games: all games in order, if the participant played several games. All values above are for the last game.
        robots: figures of each robot for the complete run.
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
    games: tuple[GameOutcome, ...] = ()
    robots: tuple[RobotStatistics, ...] = ()


class HuntUnfinished(Exception):  # noqa: N818 - nothing went wrong with the program
    """Exception: the hunt ended before the game was over, or before the participant had left. All files are complete.

    Attributes:
        outcome: result at that time.
        stopped: True after Ctrl-C or SIGTERM, False after the time limit.
    """

    def __init__(self, outcome: HuntOutcome, stopped: bool) -> None:
        super().__init__("stopped" if stopped else "the time limit was reached")
        self.outcome = outcome
        self.stopped = stopped


class Checkpoints(Protocol):
    """Sleeping copies of this process, which continue a hunt if this process is killed."""

    def take(self) -> bool:
        """Make a copy of this process, and end the earlier copy.

        Returns:
            False in this process. True in the copy, after this process was killed.
        """

    def drop(self) -> None:
        """End the copy, because the hunt is over."""


@dataclass(frozen=True, slots=True)
class PlayOptions:
    """Options of a hunt, in addition to the study.

    Attributes:
        rate: simulated seconds per second; 0 means as fast as possible.
        bag: path of the recording. If None, nothing is recorded.
        outside: names of the roles that other programs have.
        participant: description of the participant for the record, for example "person" or "suggestion".
        max_seconds: simulated time after which an unfinished game is stopped, seconds.
        graph: the ROS graph to join; None if there is none.
        left: function that returns True if the participant's window is closed; called after every tick. The hunt ends
            when the window is closed, because participants can look at the result and play again. If None, the hunt
            ends with the game.
        watch: address of the watch server; None if there is none.
        foxglove: TCP port of this machine for Foxglove; None if there is none.
        mavlink: ports of the MAVLink links; None if there are no links.
        inputs: path of the log of inputs. If None, inputs are not logged. If the log exists, the game resumes at the
            end of the log, and a simulated participant in this process repeats its decisions.
        meter: meter of the real time of this game, used if there is a log of inputs. If None, a new meter is used.
        keys: keys with which programs on other machines can take part; None if there are no keys.
        run: unique name of this run, for the record of uses of keys.
        checkpoints: copies of this process, made every `CHECKPOINT_TICKS`. They need a log of inputs. If None, only the
            log of inputs can resume the hunt.
        ticks_at_once: number of ticks that run one after the other while there are no inputs. The processor needs less
            time for them than for ticks with pauses between them, but other programs see them late.
        ros2: the ROS 2 graph to join; None if there is none.
        seats: names of the seats that participants have at the start; the hunt waits for the consent of these. If None,
            participants have all seats.
    """

    rate: float
    bag: Path | None
    outside: frozenset[str]
    participant: str
    max_seconds: float
    graph: GraphAddress | None = None
    left: Callable[[], bool] | None = None
    watch: WatchAddress | None = None
    foxglove: int | None = None
    mavlink: "MavlinkPorts | None" = None
    inputs: Path | None = None
    meter: PaceMeter | None = None
    keys: RingKeys | None = None
    run: str = ""
    checkpoints: Checkpoints | None = None
    ticks_at_once: int = 1
    ros2: Ros2Address | None = None
    seats: frozenset[str] | None = None


async def play(
    setting: StudySetting,
    participants: Sequence[TabUI],
    options: PlayOptions,
    ready: Callable[[ListeningAddress | CannotListen], None],
    progress: Callable[[TickRecord], None],
    callbacks: StartupCallbacks = NO_CALLBACKS,
) -> HuntOutcome:
    """Play one hunt with all roles that other programs do not have.

    Args:
        setting: the study.
        participants: roles of participants in this process. Other programs have the other seats; see also
            `options.outside`. If the study requires consent, these programs are asked first. Before their answers, no
            tick is run, and no file is written.
        options: options of the hunt.
        ready: callback with the address of the text server, or the reason why it cannot listen.
        progress: callback with each tick.
        callbacks: callbacks with the results of starting graph, watch server and links.

    Raises:
        ParticipantDeclined: the participant did not agree to take part, or left before the answer.
        BadFile: a file cannot be written, or the log of inputs belongs to another game (`GameDiffers`).
        HuntUnfinished: the hunt was stopped, or the time limit was reached. The recording is complete up to the end.
    """
    async with AsyncExitStack() as opened:
        # The MAVLink ports are opened first, so that no recording starts if a port cannot be opened.
        links = await _links(options.mavlink, opened, callbacks)
        if options.rate > 0.0:
            rehearse(setting)
        hunt = _Hunt(setting, participants, options, links, ready)
        await hunt.listen(opened)
        await hunt.agree()
        await hunt.record(opened, callbacks)
        went_on = await hunt.go_on(progress)
        await hunt.serve(opened, callbacks)
        if options.checkpoints is not None:
            opened.callback(options.checkpoints.drop)
        run = await run_ticks(partial(hunt.tick, progress), hunt.pacer) if went_on else LoopResult(False, 0.0)
    return hunt.outcome(run)


class _Hunt:
    """Hunt of one program: session, servers and recording.

    Args:
        setting: as in `play`.
        participants: as in `play`.
        options: as in `play`.
        links: MAVLink server with open ports, and the names of the ports.
        ready: as in `play`.

    Attributes:
        pacer: pacer of the session.
    """

    def __init__(
        self,
        setting: StudySetting,
        participants: Sequence[TabUI],
        options: PlayOptions,
        links: "tuple[MavlinkServer, list[str]] | None",
        ready: Callable[[ListeningAddress | CannotListen], None],
    ) -> None:
        self._setting, self._options, self._links, self._ready = setting, options, links, ready
        self._team = build_team(setting)
        self._programs = build_programs(setting, participants, options.outside, self._team)
        self.pacer = Pacer(options.rate, pause_abandoned=options.left)
        self._server = TextServer(admission=Admission.to(setting.study.open_to), keys=options.keys)
        outlets = SessionOutlets(self._server.perform)
        if links is not None:
            outlets = SessionOutlets(self._server.perform, links[0].transmit)
        self._recording = DeferredRecording()
        # The name of a run is the path of its log, so a resumed game has the same name.
        run = options.run if options.inputs is None else str(options.inputs.resolve())
        recording = SessionRecording([self._recording], self._recording, run)
        self._session = open_session(setting, self._programs, recording, outlets)
        self._graph = _GraphStation(self._session)
        absent = {*programs_of(seat.name for seat in setting.study.seats)} - {*self._programs.names}
        if options.seats is not None:
            absent &= {program_of(seat) for seat in options.seats}
        asks = setting.consent is not None and bool(absent)
        self._desk = ConsentDesk(self._session.router, introductions(setting, absent)) if asks else None
        self._inputs: InputLog | None = None
        self._journals: JournalStore | None = None
        self._bags: list[BagWriter] = []
        self._where: ListeningAddress | None = None
        self._checkpoint_due = CHECKPOINT_TICKS
        self._ticks_due = self._prompt_ticks = 0
        self._statistics = RunStatistics()
        self._ending = EndCondition(options.max_seconds, options.left)
        self._troubles = TroubleLog()
        self._server.note_game(*self._session.game_name)

    async def listen(self, opened: AsyncExitStack) -> None:
        """Open the port of the text server. Programs that connect wait until `agree` or `serve`."""
        server = self._setting.study.server
        opened.push_async_callback(self._server.stop)
        where = await self._server.open(server.host, server.port)
        if isinstance(where, CannotListen) and self._options.left is not None:
            where = await self._server.open(server.host, 0)  # The window gets the selected port.
        if isinstance(where, CannotListen):
            self._ready(where)
        else:
            self._where = where

    async def agree(self) -> None:
        """Ask the participant in another program for consent. Raises ParticipantDeclined: they did not agree."""
        if self._desk is not None:
            self._admit(self._desk)
            left = self._options.left
            # If a window has already asked for consent, it sends the consent as soon as it joins.
            await _consent(self._desk, left, _ignore if left is not None else _log.warning)

    async def record(self, opened: AsyncExitStack, callbacks: StartupCallbacks) -> None:
        """Start all listeners and the recording. Raises BadFile: a file cannot be written."""
        setting, options, session = self._setting, self._options, self._session
        publisher = build_publisher(setting)
        has_vehicles = setting.study.mavlink.on
        who = options.participant if self._programs.participants else ""
        opening = build_record(setting, PLAY, self._programs.names, who)
        audience = await opened.enter_async_context(
            listeners(
                options,
                setting,
                self._team,
                publisher,
                self.pacer,
                session.ask,
                callbacks,
                self._graph.receive_frame if has_vehicles else None,
                session.keys.granted,
                has_game=True,
                game_address=lambda: "" if self._where is None else f"{self._where.host}:{self._where.port}",
            )
        )
        log: EventLog | None = None
        if options.bag is not None:
            log = self._journals = opened.enter_context(closing(JournalStore(journal_of(options.bag))))
        self._bags = [each for each in audience if isinstance(each, BagWriter)]
        recorders: list[TickRecorder] = []
        if audience:
            recorders.append(build_recorder(setting, opening, audience, publisher))
        if options.bag is not None and has_vehicles and setting.study.mavlink.tlog:
            recorders.append(TlogRecorder(opened.enter_context(TlogFile(tlog_of(options.bag)))))
        if options.inputs is not None:
            meter = options.meter or PaceMeter()
            self._inputs = opened.enter_context(closing(InputLog(options.inputs, opening, meter, self.pacer)))
            # The log of inputs is the first recorder, because all other records follow from the inputs.
            recorders.insert(0, self._inputs)
        self._recording.begin(recorders, log)

    async def go_on(self, progress: Callable[[TickRecord], None]) -> bool:
        """Run as fast as possible up to the last tick of the log of inputs, and close all recorded connections.

        Args:
            progress: callback with each tick.

        Returns:
            False if the run was stopped (Ctrl-C, SIGTERM), otherwise True.
        """
        logged = () if self._inputs is None else self._inputs.ticks
        if not logged:
            return True
        with self._session.undelivered():
            run = await run_ticks(self._replay(logged, progress), Pacer(0.0))
        self._close_recorded(logged)
        return run.finished

    def _restore(self, progress: Callable[[TickRecord], None]) -> None:
        """Continue the hunt in a copy of the process that was killed, from the last tick that this process has logged.

        Nothing else may run meanwhile: input from connections must not come before the input of the log.
        """
        if self._journals is not None:
            self._journals.rewind()
        for bag in self._bags:
            bag.rewind()
        logged = () if self._inputs is None else self._inputs.reread()
        if logged:
            tick = self._replay(logged, progress)
            with self._session.undelivered():
                while tick():
                    pass
        self._close_recorded(logged)
        self._server.drop_connections()
        self.pacer.restart()
        self._checkpoint_due = self._session.tick  # This process may be killed soon, too.
        if self._where is not None:
            self._ready(self._where)

    def _replay(self, logged: Sequence[LoggedTick], progress: Callable[[TickRecord], None]) -> Callable[[], bool]:
        """Return a function that runs one tick with its logged inputs, and returns True if another one follows."""
        session, waiting = self._session, deque(logged)

        def tick() -> bool:
            if waiting[0].tick == session.tick:
                for item in waiting.popleft().inputs:
                    give(session, {}, item)
            progress(self._step())
            self._ending.reached(session)
            return bool(waiting)

        return tick

    def _close_recorded(self, logged: Sequence[LoggedTick]) -> None:
        """Close the connections that were opened in logged ticks."""
        session = self._session
        for item in chain.from_iterable(each.inputs for each in logged):
            match item:
                case ConnectionOpened(connection):
                    session.perform(session.router.eof(connection))
                case LinkOpened(link):
                    session.links.close_link(link)

    async def serve(self, opened: AsyncExitStack, callbacks: StartupCallbacks) -> None:
        """Admit ground stations and other programs."""
        on_graph = self._options.graph is not None or self._options.ros2 is not None
        if self._setting.study.mavlink.on and on_graph:
            self._graph.open()
        if self._links is not None:
            server, reached_by = self._links
            await server.serve(self._session.links)
            callbacks.linked(reached_by)
            await opened.enter_async_context(kept_alive(self._session, self.pacer))
        if self._desk is None:
            self._admit(self._session.router)
        opened.push_async_callback(self._server.stop)  # The server stops before the recording is closed.

    def tick(self, progress: Callable[[TickRecord], None]) -> bool:
        """Run the ticks that are due, or let them wait for the next ones; return True while the hunt continues."""
        self._ticks_due += 1
        if not self._session.awaits_no_input:
            self._prompt_ticks = _PROMPT_TICKS
        self._prompt_ticks -= 1
        if self._prompt_ticks < 0 and self._ticks_due < self._options.ticks_at_once and not self.pacer.paused:
            return True
        due, self._ticks_due = self._ticks_due, 0
        return all(self._tick(progress) for _ in range(due))

    def _tick(self, progress: Callable[[TickRecord], None]) -> bool:
        now = self._step()
        # Refusals to a participant in this process are not logged, because the window or terminal shows them.
        inside = {role.name for role in self._programs.participants}
        refusals = (each for each in now.refusals if each.program not in inside)
        self._troubles.note(refusals, now.utterances)
        self._server.note_game(*self._session.game_name)
        progress(now)
        if self._ending.reached(self._session):
            return False
        if self._take_checkpoint():
            self._restore(progress)
        return not self._ending.reached(self._session)

    def outcome(self, run: LoopResult) -> HuntOutcome:
        """Return the result after a run of ticks. Raises HuntUnfinished: the hunt is not finished."""
        bag = self._options.bag
        outcome = outcome_of(self._setting, self._session, self._ending, run.seconds, bag, self._statistics)
        # With a window, the hunt does not end with the game: participants may play again.
        if self._ending.tick is None or (self._options.left is not None and not run.finished):
            raise HuntUnfinished(outcome, stopped=not run.finished)
        return outcome

    def _take_checkpoint(self) -> bool:
        """Take a checkpoint if it is due. Return True in a copy, after this process was killed."""
        checkpoints = self._options.checkpoints
        if checkpoints is None or self._session.tick < self._checkpoint_due:
            return False
        # A copy has no threads, so nothing may wait for the disk. Frames of vehicles come over other sockets.
        is_possible = self._inputs is not None and self._links is None and not self._session.has_vehicles
        if not (is_possible and self._session.awaits_no_input and all(bag.is_idle for bag in self._bags)):
            return False
        self._checkpoint_due = self._session.tick + CHECKPOINT_TICKS
        return checkpoints.take()

    def _step(self) -> TickRecord:
        now = self._session.step()
        if now.snapshot is not None:
            self._statistics.add(now.snapshot)
        return now

    def _admit(self, router: RouterInterface) -> None:
        if self._where is not None:
            self._server.serve(router)
            self._ready(self._where)


class _GraphStation:
    """ROS graph in the role of a ground station, with one link to all vehicles.

    Frames are dropped before the link is open.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._link: LinkId | None = None

    def open(self) -> None:
        """Open the link."""
        self._link = self._session.links.open_link(GRAPH_LINK)

    def receive_frame(self, robot: int, frame: Frame) -> None:
        """Pass a frame to one robot, whose index is given."""
        if self._link is not None:
            self._session.transmit(self._session.links.receive_frame(self._link, frame, robot).replies)


def _ignore(sentence: str) -> None:
    """Do nothing."""


async def _consent(desk: ConsentDesk, left: Callable[[], bool] | None, report: Callable[[str], None]) -> None:
    """Wait until the participant has agreed to take part, or cannot be asked.

    Raises:
        ParticipantDeclined: the participant did not agree.
    """
    report(CONSENT_SENTENCES[desk.status])

    def waiting() -> bool:
        return desk.status is ConsentStatus.AWAITED and not (left is not None and left())

    await run_ticks(waiting, Pacer(1.0))
    if desk.status is ConsentStatus.NOT_ASKED:
        report(CONSENT_SENTENCES[desk.status])
    if not desk.status.recordable:
        raise ParticipantDeclined(desk.status is ConsentStatus.DECLINED)


async def _links(
    ports: "MavlinkPorts | None", opened: AsyncExitStack, callbacks: StartupCallbacks
) -> "tuple[MavlinkServer, list[str]] | None":
    """Return the MAVLink server with open ports, and its addresses; None if there are no links.

    If a port cannot be opened, the callback receives the reason.
    """
    if ports is None:
        return None
    # Imported here, because sessions without links do not need MAVLink.
    from thbridge.mavlink.sockets.server import MavlinkServer  # noqa: PLC0415

    links = MavlinkServer(ports)
    opened.push_async_callback(links.close)
    names = await links.open()
    if isinstance(names, CannotListen):
        callbacks.linked(names)
        return None
    return links, names


class EndCondition:
    """Condition for the end of a session.

    Args:
        max_seconds: simulated time after which an unfinished game is stopped, seconds.
        left: function that returns True if the participant's window is closed; see `PlayOptions`.
    """

    def __init__(self, max_seconds: float, left: Callable[[], bool] | None = None) -> None:
        self._last_tick = max_seconds * TICKS_PER_SECOND
        self._left = left
        self._outcomes: dict[int, GameOutcome] = {}
        self._game: GameState | None = None
        self.tick: int | None = None
        """Tick in which the game ended; None during a game."""

    @property
    def games(self) -> tuple[GameOutcome, ...]:
        """Results of the games so far, in order."""
        return tuple(self._outcomes.values())

    def reached(self, session: Session) -> bool:
        """Return True if the session is over."""
        game = session.game
        if game is not None and game is not self._game:
            # Only the results of finished games are stored, because people may play hundreds of games.
            self._outcomes[game.started.game] = _game_outcome(game)
            self._game = game
        over = session.game is not None and session.game.ended is not None
        if not over:
            self.tick = None
        elif self.tick is None:
            self.tick = session.tick
        if self._left is not None:
            return self._left() or session.tick >= self._last_tick
        if self.tick is not None:
            return session.tick >= self.tick + FINAL_TICKS
        return session.tick >= self._last_tick


def outcome_of(
    setting: StudySetting,
    session: Session,
    ending: EndCondition,
    wall: float,
    bag: Path | None,
    statistics: RunStatistics,
) -> HuntOutcome:
    """Return the result of a session, which may be unfinished."""
    snapshot = session.snapshot
    ticks = session.tick if ending.tick is None else ending.tick
    games = ending.games
    last = games[-1] if games else None
    return HuntOutcome(
        seed=setting.study.seed,
        score=0 if last is None else last.score,
        over=None if last is None else last.over,
        rooms_visited=0 if last is None else last.rooms_visited,
        identified=0 if last is None else last.identified,
        energy=() if last is None else last.energy,
        sim_seconds=round(ticks * TICK, 2),
        wall_seconds=round(wall, 2),
        collisions=0 if snapshot is None else int(snapshot.truth.collisions.sum()),
        bag=bag,
        games=games,
        robots=statistics.figures(),
    )


def _game_outcome(game: GameState) -> GameOutcome:
    return GameOutcome(
        game=game.started.game,
        score=game.score,
        over=None if game.ended is None else game.ended.reason.value,
        rooms_visited=sum(room.visited for room in game.rooms),  # of integers
        identified=sum(room.points is not None for room in game.rooms),
        energy=tuple(robot.energy for robot in game.robots),
    )
