import json
import math
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.hunt.codec import from_json, to_json
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    Condition,
    ConditionChanged,
    ConsentGiven,
    DialogueOpened,
    DialogueSaid,
    EndReason,
    Event,
    GameEnded,
    GameStarted,
    HandbackRequested,
    MoveFailed,
    PropertyMeasured,
    PropertyTold,
    RobotArrived,
    RobotDeparted,
    RoomAdvised,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
    TreasureTakenUp,
)
from thbridge.hunt.properties import OF_2016, Teller, TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind

# Written by the first release, advice by a later one: a line of every kind, then the journals of four games.
RECORDED = (Path(__file__).parent / "recorded_events.jsonl").read_text().splitlines()

numbers = st.floats(allow_nan=False, allow_infinity=False)
shares = st.floats(0, 1e9)
rooms = st.integers(0, 50).map(Room)
robots = st.integers(0, 9)
texts = st.text(max_size=12)
values = st.dictionaries(st.sampled_from(["colour", "footprint", "weight"]), texts)
treasures = st.builds(TreasureKind, values, st.integers(), texts, st.none() | texts)
properties = st.just(OF_2016) | st.lists(
    st.builds(TreasureProperty, texts, texts, told_by=st.sampled_from(Teller))
).map(tuple)
costs = st.integers(2, 4).flatmap(
    lambda size: st.lists(
        st.lists(shares | st.just(math.inf), min_size=size, max_size=size).map(tuple), min_size=size, max_size=size
    ).map(lambda rows: CostMatrix(tuple(rows)))
)
events = st.one_of(
    st.builds(
        GameStarted, st.integers(), st.integers(), st.integers(1, 9), shares, shares, shares, shares, costs, properties
    ),
    st.builds(TreasuresHidden, st.lists(treasures, max_size=4).map(tuple)),
    st.builds(ConsentGiven, at=st.sampled_from(["", "2026-11-23T09:30:00Z"])),
    st.builds(RoomAdvised, robots, rooms, robots, rooms, st.booleans(), st.none() | st.floats(0.0, 1.0)),
    st.builds(RobotDeparted, robots, rooms, numbers),
    st.builds(RobotArrived, robots, rooms),
    st.builds(MoveFailed, robots, rooms, texts, numbers, rooms),
    st.builds(ConditionChanged, robots, st.sampled_from(Condition)),
    st.builds(CommanderChanged, robots, st.sampled_from(Commander), texts),
    st.builds(HandbackRequested, robots),
    st.builds(TreasureSensed, rooms, values),
    st.builds(PropertyMeasured, rooms, robots, texts, texts, numbers),
    st.builds(PropertyTold, rooms, texts, texts),
    st.builds(TreasurePictured, rooms, robots, texts, numbers),
    st.builds(TreasureIdentified, st.none() | rooms, st.none() | robots, st.none() | texts, st.integers(), numbers),
    st.builds(TreasureLeft, rooms),
    st.builds(TreasureTakenUp, rooms),
    st.builds(GameEnded, st.sampled_from(EndReason), st.integers()),
    st.builds(
        DialogueOpened,
        robots,
        texts,
        robots,
        rooms,
        numbers,
        texts,
        st.none() | rooms,
        texts,
        st.none() | shares,
        texts,
    ),
    st.builds(DialogueSaid, robots, robots, texts, texts, texts, texts),
)


@given(events)
def test_an_event_comes_back_as_it_went(event):
    line = to_json(event)
    assert from_json(line) == event
    assert line.isascii() and "\n" not in line


@given(events, st.data())
def test_a_field_more_or_less_is_refused(event, data):
    fields = json.loads(to_json(event))
    with pytest.raises(ValueError, match=r"unknown field `extra`|Expected `str`.*properties"):
        from_json(json.dumps(fields | {"extra": 1}))
    optional = {"at"} if isinstance(event, ConsentGiven) else set()
    optional |= {"advised", "reason", "confidence", "name"} if isinstance(event, DialogueOpened) else set()
    optional |= {"properties"} if isinstance(event, GameStarted) else set()
    optional |= event.properties.keys() if isinstance(event, TreasureSensed) else set()
    missing = data.draw(st.sampled_from(sorted(fields.keys() - optional)))
    del fields[missing]
    with pytest.raises(ValueError, match=missing):
        from_json(json.dumps(fields))


@given(st.text(max_size=60) | st.recursive(st.none() | st.integers() | texts, st.lists).map(json.dumps))
def test_anything_else_is_refused_with_a_sentence(line):
    with pytest.raises(ValueError, match=r"\w"):
        from_json(line)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('{"v":2,"event":"left","room":1}', "version 2"),
        ('{"v":1,"event":"vanished","room":1}', "vanished"),
        ('{"v":1,"event":"left","room":-1}', "-1"),
        ('{"v":1,"event":"left","room":true}', "Expected `int`.*room"),
        ('{"v":1,"event":"left","room":1.0}', "Expected `int`.*room"),
        ('{"v":1,"event":"departed","robot":0,"room":1,"cost":NaN}', "cost"),
        ('{"v":1,"event":"departed","robot":0,"room":1,"cost":' + "9" * 400 + "}", "cost"),
        ('{"v":1,"event":"ended","reason":"bored","score":1}', "bored"),
        ('{"v":1,"event":"left","room":1,"room":2}', "twice"),
        ("[" * 100000, "deep"),
    ],
)
def test_what_is_wrong_is_named(line, complaint):
    with pytest.raises(ValueError, match=complaint):
        from_json(line)


def test_rooms_are_written_as_people_count():
    assert json.loads(to_json(RobotArrived(0, Room.of_wire(0)))) == {"v": 1, "event": "arrived", "robot": 0, "room": 1}


def test_infinite_energy_is_not_written():
    with pytest.raises(ValueError):
        to_json(RobotDeparted(0, Room(1), math.inf))


@pytest.mark.parametrize("line", RECORDED)
def test_lines_of_older_programs_are_read_and_written_as_they_are(line):
    assert to_json(from_json(line)) == line


def test_the_recorded_lines_have_every_kind():
    assert {type(from_json(line)) for line in RECORDED} == set(get_args(Event))


@pytest.mark.parametrize("fields", ['"name":"","image":null,"weight":1', '"name":""'])
def test_a_treasures_field_more_or_less_is_refused(fields):
    treasure = '{"colour":"","footprint":"","points":1,' + fields + "}"
    with pytest.raises(ValueError, match="treasure"):
        from_json('{"v":1,"event":"hidden","treasures":[' + treasure + "]}")
