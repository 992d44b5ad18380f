import json
from dataclasses import replace

from sim.common.geometry import Pose2
from sim.world.thing import Thing
from sim.world.things import ThingState
from tests.support.bags.drawn_team import snapshots
from tests.support.bags.remembering_recorder import RememberingRecorder
from tests.support.dialogue.recorded_dialogues import LEAVES, STUBBORN, TOPIC, recorded, utterances
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import TickRecord
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.moves import Ask, Author, DialogueUtterance, Speaker
from thbridge.dialogue.portrait import read_portrait
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.ros.messages.session_records import DialogueMoveRecord, DialogueStateRecord, GameEvent, UtteranceRecord

CRATE = ThingState(Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1)), Pose2(1.0, 2.0, 0.0)))


def test_a_robot_that_is_put_elsewhere_is_an_event_and_one_that_drives_is_not():
    tape = RememberingRecorder()
    recorder = BagRecorder(tape)
    for snapshot in snapshots(2, 100):
        poses = snapshot.world.poses.copy()
        poses[1, 0] += 0.3 * (snapshot.tick > 50)
        carried = replace(snapshot, world=replace(snapshot.world, poses=poses))
        recorder.record(TickRecord(snapshot.tick, (), carried, (), (), (), WizardState(), None))
    assert [json.loads(record.json) for record in tape.records] == [{"event": "carried", "robot": 1}]


def test_what_befalls_robots_and_things_is_an_event():
    tape = RememberingRecorder()
    recorder = BagRecorder(tape)
    (snapshot,) = snapshots(2, 1)
    for things, dead in (((CRATE,), ()), ((replace(CRATE, appeared=True),), (1,)), ((), (1,)), ((), ())):
        world = replace(snapshot.world, things=things)
        snapshot = replace(snapshot, world=world, dead=frozenset(dead))
        recorder.record(TickRecord(1, (), snapshot, (), (), (), WizardState(), None))
    assert all(isinstance(record, GameEvent) for record in tape.records)
    assert [json.loads(record.json) for record in tape.records] == [
        {"event": "appeared", "thing": "crate"},
        {"event": "died", "robot": 1},
        {"event": "vanished", "thing": "crate"},
        {"event": "revived", "robot": 1},
    ]


def test_what_robots_argue_is_recorded_move_by_move_with_what_they_make_of_it():
    ticks = utterances()
    records = [record for tick in recorded(*ticks) for record in tick]
    said = [record for record in records if isinstance(record, UtteranceRecord)]
    moves = [record for record in records if isinstance(record, DialogueMoveRecord)]
    states = [record for record in records if isinstance(record, DialogueStateRecord)]
    assert [record.move for record in said][:3] == ["assert", "assert", "challenge"]
    assert [(move.dialogue, move.speaker, f"{move.locution}({move.content})") for move in moves[:3]] == [
        (1, "human", "assert(next(Robot1, Room1))"),
        (1, "robot", "assert(not next(Robot1, Room1))"),
        (1, "human", "challenge(not next(Robot1, Room1))"),
    ]
    assert [(move.before, move.after) for move in moves[:3]] == [
        ("opening", "claimed"),
        ("claimed", "countered"),
        ("countered", "challenged"),
    ]
    # Each move has the sentence of its utterance, and each state of a game begins where the last one ended.
    assert [move.text for move in moves if not move.is_booked] == [
        record.text for record in said if record.move != "conclude"
    ]
    for game in {move.dialogue for move in moves}:
        course = [move for move in moves if move.dialogue == game and not move.is_booked]
        assert [move.after for move in course[:-1]] == [move.before for move in course[1:]]
    assert moves[-1].after == "agreement" and len(states) == len(ticks)
    assert read_portrait(states[-1].json).games[-1].end == "agreement"


def test_what_a_robot_makes_of_a_dialogue_is_recorded_when_it_changes():
    (opening, *_) = utterances()
    first, again = recorded(opening, opening)
    assert [type(record) for record in first if isinstance(record, DialogueStateRecord)]
    assert [type(record) for record in again if isinstance(record, DialogueStateRecord)] == []


def test_dialogues_that_are_left_or_misheard_show_it():
    records = [record for tick in recorded(*utterances(LEAVES)) for record in tick]
    assert [record.move for record in records if isinstance(record, UtteranceRecord)][-2:] == ["leave", "conclude"]
    assert read_portrait(records[-1].json).games[-1].end == "withdrawn"
    said = utterances(STUBBORN[:1], Manner(misheard=1.0))
    (misheard,) = (move for tick in recorded(*said) for move in tick if getattr(move, "heard", ""))
    assert misheard.text == STUBBORN[0] != misheard.heard == f"{misheard.locution}({misheard.content})"


def test_scripted_dialogues_are_recorded_as_ever():
    scripted = DialogueUtterance(1, 0, Speaker.ROBOT, Author.ROBOT, Ask(0), "Shall I?", replace(TOPIC, facts=None))
    assert recorded((scripted,)) == [(UtteranceRecord(1, "robot", 0, 1, "select-room", "Shall I?", "ask", "robot"),)]


def test_a_strategy_that_failed_is_recorded_with_the_move_that_was_made_for_it():
    told = "KeyError: 'room' (lab.py, line 7)"
    said = [replace(utterance, fault=told) for utterance in utterances()[0]]
    moves = [record for record in recorded(tuple(said))[0] if isinstance(record, DialogueMoveRecord)]
    assert {move.fault for move in moves} == {told} and {move.author for move in moves} <= {"robot", "person"}
