"""Participant, ground stations and researchers at the same robots, in any order: what holds whatever they ask for."""

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import ScriptedPlayer
from thbridge.hunt.events import Commander, CommanderChanged, GameStarted, HandbackRequested, RobotDeparted
from thbridge.hunt.game import CommandHolder, apply, begin
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import (
    ReleaseCommand,
    StationIdentify,
    StationLeave,
    StationSend,
    StationStop,
    StationTakePicture,
    TakeCommand,
)
from thbridge.roles.shared.view import (
    AnswerDialogue,
    LeaveTreasure,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    StopRobot,
    TakeUpTreasure,
)

robots = st.integers(0, 1)
rooms = st.integers(1, 8)
stations = st.sampled_from(["ground station 255", "ground station 7"])
requests = st.one_of(
    st.builds(TakeCommand, robots, stations),
    st.builds(ReleaseCommand, robots),
    st.builds(StationSend, robots, rooms),
    st.builds(StationStop, robots),
    st.builds(StationTakePicture, robots),
    st.builds(StationIdentify, robots, st.just("Pink can")),
    st.builds(StationLeave, robots),
)
wishes = st.one_of(
    st.builds(SelectRoom, robots, rooms),
    st.builds(RequestSuggestion, robots),
    st.just("agree"),
    st.builds(StopRobot, robots),
    st.builds(RequestHandback, robots),
    st.builds(LeaveTreasure, rooms),
    st.builds(TakeUpTreasure, rooms),
)
researchers = st.tuples(st.sampled_from([None, "/rviz"]), st.sampled_from([None, "/teleop"]))
steps = st.tuples(st.just("station"), requests) | st.tuples(st.just("wish"), wishes)
steps |= st.tuples(st.just("researchers"), researchers)


@settings(max_examples=40)
@given(st.lists(st.tuples(st.lists(steps, max_size=3), st.integers(0, 6)), max_size=12))
def test_only_commanders_send_robots_and_nobody_is_left_on_the_way(played):
    player = ScriptedPlayer()
    hunt = HuntWithoutSimulator(participant=TabUI(player))
    hunt.run(8)
    sent = set()
    for together, ticks in played:
        player.wish = ()
        for who, what in together:
            if who == "researchers":
                hunt.puppets.researchers = what
            elif who == "station":
                hunt.session.ask("station", what)
                sent |= {(what.robot, what.room)} if isinstance(what, StationSend) else set()
            else:
                player.wish += _wished(hunt.view(), what)
        hunt.tabui.poll_player()
        hunt.run(ticks)
    player.wish = ()
    hunt.puppets.researchers = (None, None)
    for robot in (0, 1):
        hunt.session.ask("station", ReleaseCommand(robot))
    hunt.run(80)
    assert all(robot.bound_for is None for robot in hunt.session.game.robots)
    assert all(robot.command == CommandHolder() for robot in hunt.session.game.robots)
    _judge(hunt.log.events, sent)


def _wished(view, wish):
    if wish == "agree":
        answers = tuple(AnswerDialogue(talk.dialogue, talk.turn, 0) for talk in view.dialogues if talk.choices)
        return answers + tuple(SendRobot(consent.robot, consent.room) for consent in view.consents)
    return (wish,)


def _judge(events, sent):
    started, *rest = events
    assert isinstance(started, GameStarted)
    state = begin(started)
    for event in rest:
        if isinstance(event, RobotDeparted):
            by = state.robots[event.robot].command.by
            assert by is not Commander.RESEARCHER
            assert by is Commander.PARTICIPANT or (event.robot, event.room.people) in sent
            assert event.cost <= state.robots[event.robot].energy
        if isinstance(event, HandbackRequested):
            assert state.robots[event.robot].command.by is not Commander.PARTICIPANT
        if isinstance(event, CommanderChanged):
            now = state.robots[event.robot].command
            assert now != CommandHolder(event.by, event.name) or state.robots[event.robot].intervention is not None
        state = apply(state, event)
