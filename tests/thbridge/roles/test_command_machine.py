"""Participant, ground stations and researchers at the same robots, in any order: what holds whatever they ask for."""

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.thbridge.roles.stage import Stage
from tests.thbridge.roles.test_hunt import Script
from thbridge.hunt.events import AskedBack, Commanded, Commander, Departed, Started
from thbridge.hunt.game import CommandHolder, apply, begin
from thbridge.roles.robot_requests import (
    CallBackFor,
    IdentifyFor,
    LeaveFor,
    PictureFor,
    ReleaseCommand,
    SendFor,
    TakeCommand,
)
from thbridge.roles.tabui import TabUI
from thbridge.roles.view import Answer, AskBack, CallBack, Leave, Select, SendRobot, Unsure

robots = st.integers(0, 1)
rooms = st.integers(1, 8)
stations = st.sampled_from(["ground station 255", "ground station 7"])
requests = st.one_of(
    st.builds(TakeCommand, robots, stations),
    st.builds(ReleaseCommand, robots),
    st.builds(SendFor, robots, rooms),
    st.builds(CallBackFor, robots),
    st.builds(PictureFor, robots),
    st.builds(IdentifyFor, robots, st.just("Pink can")),
    st.builds(LeaveFor, robots),
)
wishes = st.one_of(
    st.builds(Select, robots, rooms),
    st.builds(Unsure, robots),
    st.just("agree"),
    st.builds(CallBack, robots),
    st.builds(AskBack, robots),
    st.builds(Leave, rooms),
)
researchers = st.tuples(st.sampled_from([None, "/rviz"]), st.sampled_from([None, "/teleop"]))
steps = st.tuples(st.just("station"), requests) | st.tuples(st.just("wish"), wishes)
steps |= st.tuples(st.just("researchers"), researchers)


@settings(max_examples=40)
@given(st.lists(st.tuples(st.lists(steps, max_size=3), st.integers(0, 6)), max_size=12))
def test_only_commanders_send_robots_and_nobody_is_left_on_the_way(played):
    player = Script()
    stage = Stage(participant=TabUI(player))
    stage.run(8)
    sent = set()
    for together, ticks in played:
        player.wish = ()
        for who, what in together:
            if who == "researchers":
                stage.puppets.researchers = what
            elif who == "station":
                stage.session.ask("station", what)
                sent |= {(what.robot, what.room)} if isinstance(what, SendFor) else set()
            else:
                player.wish += _wished(stage.view(), what)
        stage.tabui.poll_player()
        stage.run(ticks)
    player.wish = ()
    stage.puppets.researchers = (None, None)
    for robot in (0, 1):
        stage.session.ask("station", ReleaseCommand(robot))
    stage.run(80)
    assert all(robot.bound_for is None for robot in stage.session.game.robots)
    assert all(robot.command == CommandHolder() for robot in stage.session.game.robots)
    _judge(stage.log.events, sent)


def _wished(view, wish):
    if wish == "agree":
        answers = tuple(Answer(talk.dialogue, talk.turn, 0) for talk in view.dialogues if talk.choices)
        return answers + tuple(SendRobot(consent.robot, consent.room) for consent in view.consents)
    return (wish,)


def _judge(events, sent):
    started, *rest = events
    assert isinstance(started, Started)
    state = begin(started)
    for event in rest:
        if isinstance(event, Departed):
            by = state.robots[event.robot].command.by
            assert by is not Commander.RESEARCHER
            assert by is Commander.PARTICIPANT or (event.robot, event.room.people) in sent
            assert event.cost <= state.robots[event.robot].energy
        if isinstance(event, AskedBack):
            assert state.robots[event.robot].command.by is not Commander.PARTICIPANT
        if isinstance(event, Commanded):
            now = state.robots[event.robot].command
            assert now != CommandHolder(event.by, event.name) or state.robots[event.robot].intervention is not None
        state = apply(state, event)
