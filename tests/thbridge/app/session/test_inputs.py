import json
import math
from dataclasses import fields, is_dataclass, replace
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.inputs import SendGoal
from sim.parameters import RobotParameters
from sim.robot.navigator.goals import Goal
from sim.world.thing import Thing
from thbridge.app.session.input_records import from_record, to_record
from thbridge.app.session.inputs import (
    BytesReceived,
    ClientRequest,
    ClockAdvanced,
    ConnectionBacklogged,
    ConnectionClosed,
    ConnectionOpened,
    FrameReceived,
    HeartbeatsSent,
    Input,
    LinkClosed,
    LinkOpened,
    MessageForwarded,
    NameAccepted,
    ParticipantSent,
)
from thbridge.credentials import LOCAL, PLAIN, Credentials, Right
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.records import GoalRequest, SimpleGoal
from thbridge.ros.messages.session_records import InputRecord
from thbridge.text_protocol.wire.lines import TextMessage, tokens

FLOATS = st.floats()
WORDS = st.text(min_size=1, max_size=20).filter(lambda text: tokens(text) == [text])
MESSAGES = st.builds(TextMessage, WORDS, WORDS, WORDS, st.lists(WORDS, max_size=4).map(tuple))
NUMBERS = st.integers(1, 2**40)
st.register_type_strategy(Pose2, st.builds(Pose2, FLOATS, FLOATS, FLOATS))
MARIA = Credentials("maria", (Right.PARTICIPANT, Right.WATCH))
CREDENTIALS = [LOCAL, PLAIN, MARIA, replace(MARIA, seats=("driver",))]
THINGS = st.builds(
    Thing,
    st.text(),
    st.lists(st.tuples(FLOATS, FLOATS), min_size=3, max_size=5).map(tuple),
    st.builds(Pose2, st.just(0.0), st.just(0.0), FLOATS),
    st.sampled_from([(), ((1.0, 2.0),), ((0.1, 0.2), (1e300, -1e-300))]),
    FLOATS,
    st.booleans(),
)
st.register_type_strategy(Thing, THINGS)
st.register_type_strategy(RobotParameters, st.just(RobotParameters(localization="ekf")))
st.register_type_strategy(
    np.ndarray, st.lists(FLOATS, min_size=9, max_size=9).map(lambda values: np.array(values).reshape(3, 3))
)
# Far more goals than an owner sets in one session; every owner's range in recordings holds them.
COUNTED = st.integers(0, 400_000_000)
OWNERS = st.sampled_from([owner for owner in GoalOwner if owner is not GoalOwner.STRANGER])
POSES = st.from_type(Pose2)
st.register_type_strategy(Goal, st.builds(Goal, COUNTED, POSES, OWNERS))
st.register_type_strategy(
    SimpleGoal, st.builds(SimpleGoal, st.integers(), st.none() | POSES, COUNTED, st.text(), OWNERS)
)
st.register_type_strategy(
    GoalRequest, st.builds(GoalRequest, st.integers(), st.text(), st.integers(), st.none() | POSES, COUNTED, st.text())
)
REQUESTS = st.one_of(*(st.from_type(kind) for kind in get_args(Request)))
BYTES = st.integers(0, 255)
FRAMES = st.builds(Frame, BYTES, BYTES, BYTES, st.integers(0, 2**24 - 1), st.binary(min_size=1, max_size=255), BYTES)
STRATEGIES = {
    ConnectionOpened: st.builds(ConnectionOpened, NUMBERS, FLOATS, st.sampled_from(CREDENTIALS)),
    BytesReceived: st.builds(BytesReceived, NUMBERS, WORDS, st.binary(max_size=100), FLOATS),
    ConnectionClosed: st.builds(ConnectionClosed, NUMBERS, WORDS),
    ConnectionBacklogged: st.builds(ConnectionBacklogged, NUMBERS, WORDS, NUMBERS),
    ClockAdvanced: st.builds(ClockAdvanced, FLOATS),
    ParticipantSent: st.builds(ParticipantSent, MESSAGES),
    NameAccepted: st.just(NameAccepted()),
    MessageForwarded: st.builds(MessageForwarded, MESSAGES),
    ClientRequest: st.builds(ClientRequest, st.text(), REQUESTS),
    LinkOpened: st.builds(LinkOpened, NUMBERS, WORDS),
    LinkClosed: st.builds(LinkClosed, NUMBERS, WORDS),
    HeartbeatsSent: st.just(HeartbeatsSent()),
    FrameReceived: st.builds(FrameReceived, NUMBERS, WORDS, FRAMES, st.none() | st.integers(0, 249)),
}
INPUTS = st.one_of(*(STRATEGIES[kind] for kind in get_args(Input)))


def bits(value: object) -> object:
    """A value such that equal means equal to the last bit, NaN and the sign of zero included."""
    match value:
        case float():
            return "nan" if math.isnan(value) else value.hex()
        case np.ndarray():
            return bits(value.tolist())
        case tuple() | list():
            return [bits(item) for item in value]
    if is_dataclass(value):
        return type(value), [bits(getattr(value, field.name)) for field in fields(value)]
    return type(value), value


@given(INPUTS)
def test_any_input_comes_out_of_a_bag_as_it_went_in(item: Input) -> None:
    record = unpack.outside_input(pack.outside_input(7, to_record(item)))
    assert bits(from_record(record)) == bits(item)


THERE = '"base_in_map":{"x":1.5,"y":-2.0,"theta":0.25}'


@pytest.mark.parametrize(
    ("request_", "text"),
    [
        (
            SendGoal(1, Goal(4, Pose2(1.5, -2.0, 0.25), GoalOwner.RESEARCHER)),
            f'Go {{"robot":1,"goal":{{"id":2000000004,{THERE}}}}}',
        ),
        (
            SimpleGoal(0, Pose2(1.5, -2.0, 0.25), 5, owner=GoalOwner.RESEARCHER),
            f'SimpleGoal {{"robot":0,{THERE},"number":2000000005,"refusal":""}}',
        ),
        (
            SimpleGoal(0, Pose2(1.5, -2.0, 0.25), 6),
            f'SimpleGoal {{"robot":0,{THERE},"number":1000000006,"refusal":""}}',
        ),
        (
            GoalRequest(2, "a", 7, Pose2(1.5, -2.0, 0.25), 8),
            f'GoalRequest {{"robot":2,"goal_id":"a","stamp_ns":7,{THERE},"number":1000000008,"refusal":""}}',
        ),
    ],
)
def test_a_goals_owner_is_in_its_recorded_number(request_: Request, text: str) -> None:
    record = to_record(ClientRequest("w", request_))
    assert record.line == text
    name, _, fields = text.partition(" ")
    assert record.json == f'{{"sender":"w","request":"{name}","fields":{fields}}}'
    assert from_record(record) == ClientRequest("w", request_)


def test_people_can_read_what_came_in() -> None:
    record = to_record(BytesReceived(3, "TabUI", b"%%goto TabUI SimR 0 4 \r\n", 12.5))
    assert (record.kind, record.sender, record.line) == ("received", "TabUI", "%%goto TabUI SimR 0 4 ")
    assert json.loads(record.json)["now"] == 12.5


@pytest.mark.parametrize(
    "record",
    [
        InputRecord("sung", "TabUI", "", "{}"),
        InputRecord("said", "TabUI", "", "{"),
        InputRecord("said", "TabUI", "", "{}"),
        InputRecord("opened", "", "", '{"connection":"one","now":0.0}'),
        InputRecord("asked", "", "", '{"sender":"x","request":"Dance","fields":{}}'),
        InputRecord("asked", "", "", '{"sender":"x","request":"Halt","fields":{"robot":"one"}}'),
    ],
)
def test_what_no_release_wrote_is_refused(record: InputRecord) -> None:
    with pytest.raises(ValueError):
        from_record(record)
