"""Command protocol, which checks, executes and acknowledges commands.

The vehicle answers each command with one COMMAND_ACK to the sender. For a long command it first sends acknowledgements
with IN_PROGRESS.

Source: the MAVLink developer guide, "Command Protocol".
Differences from the source: a station that repeats a completed command does not always increase `confirmation` (MAVSDK
never does). So, for commands that have a new effect at each execution, an equal command within a second also counts as
a repetition. Commands that any station may send are executed at each repetition. Otherwise a stop could be mistaken for
a repetition of an earlier stop.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.vehicle_interface import Denied, LegState, RobotReadings, Station
from thbridge.mavlink.vehicle.command.requests import (
    INVALID_PARAM,
    CommandAccess,
    CommandCarrier,
    CommandReply,
    CommandResult,
    ReceivedCommand,
    parse_command,
    reply_to,
)
from thbridge.mavlink.vehicle.command.table import CommandTable
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.mavlink.vehicle.parts import Announce, Microservice, TextSeverity
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.extra_messages import CommandCancel
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

_REMEMBERED = 5 * TICKS_PER_SECOND
"""Ticks after the answer to a command. During this time, a repetition of the command is recognized."""

_MOST_REMEMBERED = 64

_Key: TypeAlias = tuple[LinkId, Station, int]
"""Link, sender and number of a command."""


@dataclass(frozen=True, slots=True)
class _Done:
    """Answered command.

    Attributes:
        request: command as received.
        tick: tick of the answer.
        result: result in the answer.
        once: True if each execution of the command has a new effect.
    """

    request: ReceivedCommand
    tick: int
    result: CommandResult
    once: bool


@dataclass(slots=True)
class _Running:
    """Command in progress, which is a drive to a place.

    Attributes:
        request: command as received.
        leg: number of the drive.
        length: length of the drive in meters. None while unknown.
        progress: percentage of the length that the robot has driven.
        reported: tick of the last acknowledgement.
    """

    request: ReceivedCommand
    leg: int
    length: float | None
    progress: int
    reported: int


class CommandProtocol(Microservice):
    """Command protocol of one vehicle.

    Args:
        commands: command table.
        control: the station in command of the robot.
        modes: the robot's mode state machine.
        announce: sends texts to people.
    """

    def __init__(
        self, commands: CommandTable, control: OperatorControl, modes: ModeStateMachine, announce: Announce
    ) -> None:
        self._commands = commands
        self._control = control
        self._modes = modes
        self._announce = announce
        self._tick = 0
        self._done: dict[_Key, _Done] = {}
        self._running: dict[_Key, _Running] = {}

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Process a command, or the cancellation of a command."""
        if isinstance(message, CommandCancel):
            yield from self._cancel(link, sender, message.command)
            return
        request = parse_command(link, sender, message)
        if request is None:
            return
        key = (link, sender, request.number)
        repeated = self._repeated(key, request)
        if repeated is not None:
            yield repeated
            return
        if key in self._running:
            # The command in progress continues, and later acknowledgements with this number are for it.
            yield _ack(request, CommandResult.TEMPORARILY_REJECTED)
            return
        reply = self._judged(request)
        if reply.sentence:
            self._announce(TextSeverity.WARNING, reply.sentence)
        if reply.leg is not None:
            self._running[key] = _Running(request, reply.leg, None, 0, self._tick)
        else:
            self._remember(key, request, reply.result)
        yield _ack(request, reply.result)
        for answer in reply.messages:
            yield OutgoingMessage(answer, link)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Send acknowledgements for commands in progress: each second, and at their end."""
        self._tick = tick
        for key, running in list(self._running.items()):
            result = self._result_of(running)
            if result is not CommandResult.IN_PROGRESS:
                del self._running[key]
                yield _ack(running.request, result)
            elif tick - running.reported >= TICKS_PER_SECOND:
                running.reported = tick
                yield _ack(running.request, result, running.progress)

    def forget(self, link: LinkId) -> None:
        """Forget a closed link. Its commands continue without acknowledgements."""
        self._done = {key: done for key, done in self._done.items() if key[0] != link}
        self._running = {key: running for key, running in self._running.items() if key[0] != link}

    # -- rules ----------------------------------------------------------------------------------------------------

    def _judged(self, request: ReceivedCommand) -> CommandReply:
        command = self._commands.find(request.number)
        if command is None:
            return CommandReply(CommandResult.UNSUPPORTED)
        if command.carrier is CommandCarrier.LONG and request.frame is not None:
            return CommandReply(CommandResult.COMMAND_LONG_ONLY)
        if command.carrier is CommandCarrier.INT and request.frame is None:
            return CommandReply(CommandResult.COMMAND_INT_ONLY)
        if command.frames and request.frame is not None and request.frame not in command.frames:
            return CommandReply(CommandResult.UNSUPPORTED_MAV_FRAME)
        # NaN means that a parameter is not given. Infinity has no meaning.
        if any(math.isinf(value) for value in request.params):
            return INVALID_PARAM
        objection = self._objection(command.access, request.station)
        return command.do(request) if objection is None else reply_to(objection)

    def _objection(self, access: CommandAccess, station: Station) -> Denied | None:
        match access:
            case CommandAccess.COMMANDER:
                return self._control.objection(station)
            case CommandAccess.NO_RIVAL:
                return self._control.reserved(station)
            case CommandAccess.ANYBODY:
                return None

    def _repeated(self, key: _Key, request: ReceivedCommand) -> OutgoingMessage | None:
        """Return the earlier acknowledgement if a command is a repetition, otherwise None."""
        done = self._done.get(key)
        if done is None or not _same(request, done.request):
            return None
        age = self._tick - done.tick
        counted = request.confirmation > done.request.confirmation and age <= _REMEMBERED
        at_once = done.once and done.result is CommandResult.ACCEPTED and age <= TICKS_PER_SECOND
        return _ack(request, done.result) if counted or at_once else None

    def _remember(self, key: _Key, request: ReceivedCommand, result: CommandResult) -> None:
        command = self._commands.find(request.number)
        if command is None or command.access is CommandAccess.ANYBODY:
            # Commands that any station may send, such as a stop, may be needed again. So they are executed again.
            return
        self._done.pop(key, None)
        while len(self._done) >= _MOST_REMEMBERED:
            del self._done[next(iter(self._done))]
        self._done[key] = _Done(request, self._tick, result, command.once)

    def _cancel(self, link: LinkId, sender: Station, number: int) -> Iterator[OutgoingMessage]:
        running = self._running.pop((link, sender, number), None)
        if running is not None:
            self._modes.stop()
            yield _ack(running.request, CommandResult.CANCELLED)

    def _result_of(self, running: _Running) -> CommandResult:
        """Return the current result of a command in progress, and update its progress."""
        # Another drive has replaced the drive of this command.
        if self._modes.drive.number != running.leg:
            return CommandResult.CANCELLED
        leg = self._modes.drive.leg
        if leg is None:
            return CommandResult.IN_PROGRESS
        if leg.state is LegState.ARRIVED:
            return CommandResult.ACCEPTED
        if leg.state is LegState.FAILED:
            return CommandResult.FAILED
        # A new plan may be longer. Progress must stay between 0 and 99 % until the end.
        if running.length is None or leg.remaining > running.length:
            running.length = leg.remaining
        if running.length > 0.0:
            running.progress = min(99, int(100.0 * (1.0 - leg.remaining / running.length)))
        return CommandResult.IN_PROGRESS


def _same(one: ReceivedCommand, other: ReceivedCommand) -> bool:
    """Return True for commands that are equal except for `confirmation`. NaN counts as equal to NaN."""
    return one.frame == other.frame and all(
        a == b or (math.isnan(a) and math.isnan(b)) for a, b in zip(one.params, other.params, strict=True)
    )


def _ack(request: ReceivedCommand, result: CommandResult, progress: int = 0) -> OutgoingMessage:
    station = request.station
    return OutgoingMessage(
        mav.MAVLink_command_ack_message(request.number, result, progress, 0, station.system, station.component),
        request.link,
    )
