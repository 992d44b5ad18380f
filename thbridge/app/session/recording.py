"""Recorders of a session, for the bag and for the telemetry log."""

import json
from collections.abc import Iterator
from typing import Protocol

import numpy as np

from sim.common.observations import TICKS_PER_SECOND
from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.snapshot import TeamSnapshot
from thbridge.app.session.dialogue_states import DialogueStates
from thbridge.app.session.input_records import to_record
from thbridge.app.session.inputs import ClientRequest
from thbridge.app.session.mavros import frame_record, state_record
from thbridge.app.session.session import TickRecord
from thbridge.dialogue import moves
from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.hunt import events
from thbridge.hunt.codec import kind_of, to_json
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.mavlink.wire.outgoing import VehicleStatus
from thbridge.roles.keeper.agreements import MATTERS
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.roles.shared.notices import KEEPER
from thbridge.roles.shared.seat_programs import seat_name_of
from thbridge.roles.shared.team_notices import TeamTalk
from thbridge.roles.shared.view import View
from thbridge.ros.messages.records import GraphRequest, Record, SendRobots, Success
from thbridge.ros.messages.session_records import (
    DialogueMoveRecord,
    GameEvent,
    HeldTurns,
    ScoreRecord,
    SeatNotice,
    TeamEvent,
    UtteranceRecord,
)
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.text_protocol.wire import legacy, notice_format
from thbridge.text_protocol.wire.notice_format import Notice, parse_notice
from thbridge.text_protocol.wire.router import Forwarded

JUMP = 0.2
"""Distance in meters that a robot cannot drive in one tick. A robot that moves farther was kidnapped (by hand)."""

_SHORTEST_PART = 0.7 * JUMP
"""Of a motion that is longer than `JUMP`, the part along x or along y is longer than this."""

_SHOWN = frozenset({notice_format.kind_of(View), notice_format.kind_of(TeamTalk)})

STATE_PERIOD = TICKS_PER_SECOND
"""An unchanged state of a vehicle is recorded again after this number of ticks."""


class TickPublisher(Protocol):
    """Publisher of ticks; see `Broadcast`."""

    def record(self, snapshot: TeamSnapshot, records: tuple[Record, ...]) -> None:
        """Publish one tick."""


class BagRecorder:
    """Recorder of every tick of a session with robots.

    Args:
        publisher: publisher of the ticks.
    """

    def __init__(self, publisher: TickPublisher) -> None:
        self._publisher = publisher
        self._score: ScoreRecord | None = None
        self._dialogues = DialogueStates()
        self._wizard = WizardState()
        self._collisions: tuple[int, ...] = ()
        self._things: tuple[str, ...] = ()
        self._dead: frozenset[int] = frozenset()
        self._places: FloatArray | None = None
        self._vehicles: tuple[VehicleStatus, ...] = ()

    def record(self, record: TickRecord) -> None:
        """Record one tick. Exceptions of the publisher are raised."""
        if record.snapshot is not None:
            self._publisher.record(record.snapshot, tuple(self._records(record)))

    def _records(self, record: TickRecord) -> Iterator[Record]:
        for item in record.inputs:
            yield to_record(item)
            if isinstance(item, ClientRequest) and isinstance(item.request, GraphRequest):
                yield from self._client_requests(record, item.request)
        for forwarded in record.forwarded:
            yield from _lines(forwarded)
            yield from _shown(forwarded)
        for event in record.events:
            yield _event(event)
        for entry in record.team:
            yield TeamEvent(_event(entry))
        for utterance in record.utterances:
            yield _utterance(utterance)
            yield from _formal_moves(utterance)
            if utterance.authored is not None:
                yield _authored(utterance, utterance.authored)
        yield from self._dialogues.changed(record.utterances, record.team)
        if record.wizard != self._wizard:
            self._wizard = record.wizard
            yield HeldTurns(record.wizard.json())
        if record.snapshot is not None and record.snapshot.world is not None:
            yield from self._touches(record.snapshot)
            yield from self._incidents(record.snapshot)
        yield from map(frame_record, record.traffic)
        yield from self._states(record)
        score = None if record.game is None else _score(record.game)
        if score is not None and score != self._score:
            self._score = score
            yield score

    def _client_requests(self, record: TickRecord, request: GraphRequest) -> Iterator[Record]:
        """Yield the record of a ROS client's request, if the robot of the request exists."""
        if record.snapshot is not None and request.robot < len(record.snapshot.robots):
            yield request

    def _states(self, record: TickRecord) -> Iterator[Record]:
        """Yield the changed states of vehicles; after each `STATE_PERIOD`, yield the states of all vehicles."""
        before, self._vehicles = self._vehicles, record.vehicles
        for robot, status in enumerate(record.vehicles):
            if record.tick % STATE_PERIOD == 0 or not before or status != before[robot]:
                yield state_record(robot, status)

    def _touches(self, snapshot: TeamSnapshot) -> Iterator[GameEvent]:
        """Yield an event for each robot that has begun to touch a wall or another robot."""
        counts = tuple(snapshot.truth.collisions.tolist())
        before, self._collisions = self._collisions, counts
        for robot, count in enumerate(counts):
            if count > (before[robot] if before else 0):
                text = json.dumps({"event": "collision", "robot": robot, "count": count})
                yield GameEvent("collision", robot, None, text)

    def _incidents(self, snapshot: TeamSnapshot) -> Iterator[GameEvent]:
        """Yield events for things that appeared or vanished, and for robots that died, revived or were kidnapped."""
        things = tuple(presence.thing.name for presence in snapshot.truth.things if presence.appeared)
        before, self._things = self._things, things
        for kind, names, others in (("appeared", things, before), ("vanished", before, things)):
            for name in names:
                if name not in others:
                    yield GameEvent(kind, None, None, json.dumps({"event": kind, "thing": name}))
        dead, self._dead = self._dead, snapshot.dead
        for kind, robots in (("died", self._dead - dead), ("revived", dead - self._dead)):
            for robot in sorted(robots):
                yield _incident(kind, robot)
        places = snapshot.truth.poses[:, :2]
        if self._places is not None:
            moved = places - self._places
            if np.abs(moved).max(initial=0.0) > _SHORTEST_PART:
                for robot in np.flatnonzero(elementary_arrays.hypot(*moved.T) > JUMP).tolist():
                    yield _incident("carried", robot)
        self._places = places.copy()


class TlogRecorder:
    """Recorder of the frames that vehicles receive and send.

    Args:
        tlog: the file, which the caller closes.
    """

    def __init__(self, tlog: TlogFile) -> None:
        self._tlog = tlog

    def record(self, record: TickRecord) -> None:
        """Record one tick. Raises BadFile: the file cannot be written."""
        if record.snapshot is not None and record.traffic:
            self._tlog.record(stamp_ns(record.snapshot.tick), record.traffic)


def _incident(kind: str, robot: int) -> GameEvent:
    return GameEvent(kind, robot, None, json.dumps({"event": kind, "robot": robot}))


def _lines(forwarded: Forwarded) -> Iterator[Record]:
    message = forwarded.message
    match forwarded.legacy_value:
        case legacy.GotoRoom() if message.receiver == legacy.SIMR:
            yield SendRobots(message.line())
        case legacy.RoomReached() if message.sender == legacy.SIMR:
            yield Success(message.line())


def _shown(forwarded: Forwarded) -> Iterator[SeatNotice]:
    """Yield the record of a notice that shows the game, or texts, to the participant of a seat."""
    message = forwarded.message
    seat = seat_name_of(message.receiver)
    if not (seat and forwarded.delivered and message.sender == KEEPER):
        return
    notice = parse_notice(message)
    if isinstance(notice, Notice) and notice.kind in _SHOWN:
        yield SeatNotice(seat, notice.kind, json.dumps(notice.fields))


def _event(event: events.Event | events.TeamEntry) -> GameEvent:
    robot: int | None = getattr(event, "robot", None)
    room: Room | None = getattr(event, "room", None)
    return GameEvent(kind_of(type(event)), robot, None if room is None else room.people, to_json(event))


def _utterance(utterance: moves.DialogueUtterance) -> UtteranceRecord:
    return UtteranceRecord(
        dialogue=utterance.dialogue,
        speaker="robot" if utterance.speaker is moves.Speaker.ROBOT else "human",
        robot=utterance.topic.robot,
        room=utterance.topic.room.people,
        scenario=MATTERS[utterance.topic.scenario],
        text=utterance.text,
        author=f"{utterance.author} {utterance.seat}".rstrip(),
        move=moves.word_of(utterance.move),
    )


def _formal_moves(utterance: moves.DialogueUtterance) -> Iterator[DialogueMoveRecord]:
    if utterance.conversation is None:
        return
    for formal in utterance.formal:
        play = utterance.conversation.play(formal.dialogue)
        # Only the last move can have a stalemate, because after all earlier moves, further moves were possible.
        is_stalemate = play.end is DialogueEnd.STALEMATE and formal.index == len(play.moves) - 1
        yield DialogueMoveRecord(
            talk=utterance.dialogue,
            dialogue=formal.dialogue,
            parent=formal.parent,
            index=formal.index,
            robot=utterance.topic.robot,
            speaker=formal.side,
            author=f"{utterance.author} {utterance.seat}".rstrip(),
            game=play.game.name,
            locution=formal.move.locution,
            content=str(formal.move.content),
            before=formal.before,
            after=DialogueEnd.STALEMATE if is_stalemate else formal.after,
            is_booked=formal.is_booked,
            text="" if formal.is_booked else utterance.text,
            heard="" if formal.is_booked else utterance.heard,
            fault=utterance.fault,
        )


def _authored(utterance: moves.DialogueUtterance, authored: moves.OfferedSentence) -> GameEvent:
    """Return the event for a sentence by an installed author: request, offer, and reason for a rejection."""
    fields = {
        "event": "authored",
        "robot": utterance.topic.robot,
        "dialogue": utterance.dialogue,
        "index": utterance.index,
        "move": str(utterance.move),
        "sentence": authored.sentence,
        "offered": authored.offered,
        "refused": authored.refused,
        "why": authored.why,
    }
    return GameEvent("authored", utterance.topic.robot, utterance.topic.room.people, json.dumps(fields))


def _score(game: GameState) -> ScoreRecord:
    return ScoreRecord(
        score=game.score,
        visited=sum(room.visited for room in game.rooms),  # of integers
        rooms=len(game.rooms),
        energy=tuple(robot.energy for robot in game.robots),
    )
