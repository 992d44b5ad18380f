"""Requests of ground stations to the game. They obey the rules for the participant's requests, without dialogues."""

from typing import TypeAlias

from sim.common.robot_numbers import robot_name
from thbridge.hunt import rules
from thbridge.hunt.events import Commander, CommanderChanged
from thbridge.hunt.game import CommandHolder, GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.robot_requests import (
    CommandRequest,
    ReleaseCommand,
    StationIdentify,
    StationLeave,
    StationSend,
    StationStop,
    StationTakePicture,
    TakeCommand,
)
from thbridge.roles.shared.view import SendRobot
from thbridge.text_protocol.wire.notice_format import kind_of

JudgedRequest: TypeAlias = (
    TakeCommand | ReleaseCommand | StationSend | StationTakePicture | StationIdentify | StationLeave
)


def handle_station_request(
    game: OpenGame, state: GameState, request: CommandRequest, *, awaits_treasures: bool
) -> None:
    """Carry out the request of a ground station. A refused request is dropped without a message.

    Args:
        game: the game in progress.
        state: state of the game.
        request: the request.
        awaits_treasures: True if Hider has not hidden the treasures yet. Then no robot is sent.
    """
    match request:
        case StationStop(robot):
            if state.has_robot(robot) and state.robots[robot].bound_for is not None:
                _stop(game, state, robot)
        case StationSend() if awaits_treasures:
            pass
        case _:
            ruling = ruling_on(state, request)
            if isinstance(ruling, tuple):
                game.record(ruling)


def sense_for_stations(game: OpenGame, state: GameState) -> None:
    """Let robots that ground stations command sense the treasure on arrival, because stations cannot request it.

    With a Hider of 2016, this is not possible, because it does not reveal the treasures.
    """
    for robot in state.robots:
        held = robot.holder.by is Commander.GROUND_STATION
        if held and robot.bound_for is None and not robot.at.is_corridor and state.treasures is not None:
            seen = rules.sense(state, robot.at)
            if isinstance(seen, tuple):
                game.record(seen)


def kept_commands(former: GameState, robots: int) -> tuple[CommanderChanged, ...]:
    """Return the events by which ground stations keep their robots in the next game; it has `robots` robots."""
    return tuple(
        CommanderChanged(number, robot.holder.by, robot.holder.name)
        for number, robot in enumerate(former.robots[:robots])
        if robot.holder.by is Commander.GROUND_STATION
    )


def return_robots(game: OpenGame) -> None:
    """Let the participant command all robots, because no other commander is connected after a restart."""
    robots = () if game.state is None else game.state.robots
    game.record(
        tuple(
            CommanderChanged(number, Commander.PARTICIPANT, robot.seat)
            for number, robot in enumerate(robots)
            if robot.command.by is not Commander.PARTICIPANT
        )
    )


def _stop(game: OpenGame, state: GameState, robot: int) -> None:
    """Stop a robot.

    If the robot is not stopping yet and the participant commands it, a refusal states that a ground station stopped it.
    """
    if not game.moves.is_stopping(robot) and state.robots[robot].command.by is Commander.PARTICIPANT:
        sentence = f"A ground station has stopped {robot_name(robot)}."
        game.refuse(kind_of(SendRobot), RequestRefused(KeeperReason.STOPPED, sentence), robot)
    game.stop(robot)


def ruling_on(state: GameState, request: JudgedRequest) -> rules.Ruling:
    """Return the events of a ground station's request, or its refusal."""
    match request:
        case TakeCommand(robot, name):
            return rules.command(state, robot, CommandHolder(Commander.GROUND_STATION, name))
        case ReleaseCommand(robot):
            return rules.command(
                state, robot, CommandHolder(name=state.robots[robot].seat if state.has_robot(robot) else "")
            )
        case StationSend(robot, room):
            return rules.move(state, robot, Room(max(room, 0)), Commander.GROUND_STATION)
        case StationTakePicture() | StationIdentify() | StationLeave():
            return _about_treasure(state, request)


def _about_treasure(state: GameState, request: StationTakePicture | StationIdentify | StationLeave) -> rules.Ruling:
    if not state.has_robot(request.robot):
        return RequestRefused(rules.RuleReason.UNKNOWN_ROBOT, f"There is no {robot_name(request.robot)}.")
    refused = rules.commanded_by_other(state, request.robot, Commander.GROUND_STATION)
    if refused is not None:
        return refused
    here = state.robots[request.robot].at
    match request:
        case StationTakePicture():
            return rules.picture(state, here)
        case StationIdentify(name=name):
            return rules.identify(state, here, name)
        case StationLeave():
            return rules.leave(state, here)
