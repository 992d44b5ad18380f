"""Effects of forwarded lines of 2016 on the game, and Hider's answers.

Our own Hider sends the treasures to the keeper, and the keeper answers all questions. A Hider of 2016 does not reveal
the treasures; then the keeper uses Hider's answers.
"""

from collections.abc import Callable
from enum import StrEnum

from sim.common.robot_numbers import robot_name
from thbridge.hunt import rules
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.hunt.properties import labelled, named_by_labels
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import Seat
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.shared.participant_lines import LineRequest, decode_request_line
from thbridge.roles.shared.participant_rules import KeeperReason, place
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.view import DialogueMatter, IdentifyTreasure, SendRobot, SenseTreasure, TakePicture
from thbridge.text_protocol.wire import canonical, legacy
from thbridge.text_protocol.wire.lines import TextCommand, TextMessage, UnreadableText
from thbridge.text_protocol.wire.notice_format import kind_of
from thbridge.text_protocol.wire.router import Forwarded

_COMMANDS_TO_SIMR = frozenset({TextCommand.GOTO, TextCommand.WHERE, TextCommand.MOVE})


def undone(line: Forwarded, state: GameState | None) -> RequestRefused | None:
    """Return the reason why no rule applies to a line, or None."""
    if not line.delivered:
        return RequestRefused(LineReason.NOBODY, f"No program is called {line.message.receiver} here.")
    if line.message.receiver == legacy.HIDER and isinstance(line.legacy_value, UnreadableText):
        return RequestRefused(LineReason.UNREADABLE, "It is not a line of the hunt of 2016.")
    if line.message.receiver == legacy.SIMR and line.message.command in _COMMANDS_TO_SIMR:
        value = canonical.decode(line.message)
        if isinstance(value, UnreadableText):
            return RequestRefused(LineReason.UNREADABLE, f"SimR cannot read it: {value.reason}.")
    if state is None and decode_request_line(line) is not None:
        return RequestRefused(LineReason.NO_GAME, "There is no game yet, because no robots have joined.")
    return None


class LineReason(StrEnum):
    """Reason why a line has no effect."""

    NOBODY = "nobody"
    UNREADABLE = "unreadable"
    NO_GAME = "no-game"


class LegacyLines:
    """Handler of forwarded lines.

    Args:
        game: the game in progress.
    """

    def __init__(self, game: OpenGame) -> None:
        self._game = game
        # Name of a treasure for which a Hider of 2016 has not sent the points yet: number of the game, room, name.
        self._named: tuple[int, Room, str] | None = None

    def handle(self, state: GameState, line: Forwarded, *, needs_consent: bool) -> TextMessage | None:
        """Handle a forwarded line.

        Args:
            state: state of the game.
            line: the line.
            needs_consent: True if the sender has its dialogues with this keeper, so that acts need an agreement.

        Returns:
            The message that our own Hider must send to the participant, or None.
        """
        request = decode_request_line(line)
        if request is None:
            self._report(state, line)
        elif line.message.receiver == (legacy.SIMR if isinstance(request, SendRobot) else legacy.HIDER):
            return self._request(state, request, needs_consent)
        return None

    def carry_out(self, state: GameState, request: LineRequest, seat: Seat) -> None:
        """Carry out a request of the participant of a seat, or store its refusal."""
        refused = why_not_allowed(state, seat, request)
        if refused is None:
            self._request(state, request, needs_consent=True)
        else:
            self._game.refuse(kind_of(type(request)), refused)

    def _request(self, state: GameState, request: LineRequest, needs_consent: bool) -> TextMessage | None:
        """Handle a request of the participant. Return Hider's answer."""
        match request:
            case SendRobot(robot, room):
                self._send(state, robot, place(room), needs_consent)
                return None
            case SenseTreasure(room):
                return self._sense(state, place(room))
            case TakePicture(room):
                return self._picture(state, place(room), needs_consent)
            case IdentifyTreasure(room, name):
                return self._identify(state, place(room), name, needs_consent)

    def _report(self, state: GameState, line: Forwarded) -> None:
        """Process a report of SimR or of a Hider of 2016."""
        game, message = self._game, line.message
        match line.legacy_value:
            case legacy.RoomReached(robot, room) if message.sender == legacy.SIMR:
                self._arrived(state, robot, Room.of_wire(room))
            case legacy.FoundTreasure(room, senses) if message.sender == legacy.HIDER:
                sensed = named_by_labels(state.started.properties, senses)
                self._apply_reported(state, lambda: rules.sense(state, Room.of_wire(room), sensed))
            case legacy.TreasureImage(room, filename) if message.sender == legacy.HIDER:
                self._apply_reported(state, lambda: rules.picture(state, Room.of_wire(room), filename))
            case legacy.PointsAwarded(points) if message.sender == legacy.HIDER and self._named is not None:
                (number, place, name), self._named = self._named, None
                if game.last_game == number:
                    self._apply_reported(state, lambda: rules.identify(state, place, name, points))

    def ruling(self, state: GameState, request: SendRobot | IdentifyTreasure) -> rules.Ruling:
        """Return the events of a request of our own program, or its refusal, without any effect."""
        match request:
            case SendRobot(robot, room):
                return self._move(state, robot, place(room), needs_consent=True)
            case IdentifyTreasure(room, name):
                at = place(room)
                return self._agreed(rules.identify(state, at, name), state, at, "take-treasure", name)

    def _send(self, state: GameState, robot: int, room: Room, needs_consent: bool) -> None:
        if not _has_gone(state, robot, room, arrived=needs_consent):
            self._game.apply_ruling(kind_of(SendRobot), self._move(state, robot, room, needs_consent=needs_consent))

    def _move(self, state: GameState, robot: int, room: Room, *, needs_consent: bool) -> rules.Ruling:
        """Return the events of a robot's move, or a refusal, for example without an agreement with the robot."""
        ruling = rules.move(state, robot, room)
        if (
            isinstance(ruling, tuple)
            and needs_consent
            and not self._game.dialogues.agreements.is_agreed(robot, "select-room", room)
        ):
            name = robot_name(robot)
            return RequestRefused(KeeperReason.NO_CONSENSUS, f"You have not agreed with {name} that it goes to {room}.")
        return ruling

    def _arrived(self, state: GameState, robot: int, room: Room) -> None:
        here = state.robots[robot] if state.has_robot(robot) else None
        # SimR repeats the line if it does not know whether the first line was received.
        if here is not None and (here.bound_for is not None or here.at != room):
            self._game.apply_ruling("Arrived", rules.arrive(state, robot, room))

    def _sense(self, state: GameState, room: Room) -> TextMessage | None:
        if state.treasures is None:
            return None
        known = state.has_room(room) and state.room(room).sensed is not None
        if not known and not self._game.apply_ruling(kind_of(SenseTreasure), rules.sense(state, room)):
            return None
        treasure = state.treasure(room)
        if treasure is None:
            return None
        return legacy.FoundTreasure(room.wire, labelled(state.started.properties, treasure.properties)).message()

    def _picture(self, state: GameState, room: Room, needs_consent: bool) -> TextMessage | None:
        if state.treasures is None:
            return None
        # A picture that was already taken is sent again, wherever the robot is now.
        if not state.has_room(room) or state.room(room).image is None:
            ruling = rules.picture(state, room)
            if needs_consent:
                ruling = self._agreed(ruling, state, room, "take-picture")
            if not self._game.apply_ruling(kind_of(TakePicture), ruling):
                return None
        treasure = state.treasure(room)
        if treasure is None or treasure.image is None:
            return None
        return legacy.TreasureImage(room.wire, treasure.image).message()

    def _identify(self, state: GameState, room: Room, name: str, needs_consent: bool) -> TextMessage | None:
        if state.treasures is None:
            self._named = (self._game.last_game, room, name)
            return None
        decided = state.room(room).points if state.has_room(room) else None
        if decided is not None:
            # The first answer was lost. The points do not change and are sent again.
            return legacy.PointsAwarded(decided).message()
        ruling = rules.identify(state, room, name)
        if needs_consent:
            ruling = self._agreed(ruling, state, room, "take-treasure", name)
        if not self._game.apply_ruling(kind_of(IdentifyTreasure), ruling) or self._game.state is None:
            return None
        return legacy.PointsAwarded(self._game.state.room(room).points or 0).message()

    def _agreed(
        self, ruling: rules.Ruling, state: GameState, room: Room, matter: DialogueMatter, name: str = ""
    ) -> rules.Ruling:
        """Return the ruling if robot and participant agreed on it, otherwise a refusal."""
        robot = state.decider(room)
        if isinstance(ruling, RequestRefused) or robot is None:
            return ruling
        if not self._game.dialogues.agreements.is_agreed(robot, matter, room, name):
            return RequestRefused(KeeperReason.NO_CONSENSUS, f"You have not agreed on that with {robot_name(robot)}.")
        return ruling

    def _apply_reported(self, state: GameState, rule: Callable[[], rules.Ruling]) -> None:
        """Apply the answer of a Hider of 2016. Ignore our own Hider, which only repeats the keeper's decisions."""
        if state.treasures is None:
            ruling = rule()
            if isinstance(ruling, tuple):
                self._game.record(ruling)


def _has_gone(state: GameState, robot: int, room: Room, *, arrived: bool) -> bool:
    """Return True if the participant has already sent a robot to this room, and the robot is driving there.

    Args:
        state: state of the game.
        robot: index of the robot.
        room: the room.
        arrived: True to include a robot that is already in the room. Our own programs see this in the view. Programs of
            2016 need the refusal.
    """
    if not state.has_robot(robot):
        return False
    mover = state.robots[robot]
    drives = mover.bound_for == room and mover.command.by is Commander.PARTICIPANT
    return drives or (arrived and mover.bound_for is None and mover.at == room)
