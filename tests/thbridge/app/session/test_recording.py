import json
from dataclasses import replace

from sim.common.geometry import Pose2
from sim.world.thing import Thing
from sim.world.things import ThingState
from tests.thbridge.ros.drive import snapshots
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import TickRecord
from thbridge.roles.keeper.wizard import WizardState
from thbridge.ros.messages.session_records import GameEvent

CRATE = ThingState(Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1)), Pose2(1.0, 2.0, 0.0)))


class Tape:
    """A recorder that remembers."""

    def __init__(self):
        self.records = []

    def record(self, snapshot, records):
        self.records += records


def test_a_robot_that_is_put_elsewhere_is_an_event_and_one_that_drives_is_not():
    tape = Tape()
    recorder = BagRecorder(tape)
    for snapshot in snapshots(2, 100):
        poses = snapshot.world.poses.copy()
        poses[1, 0] += 0.3 * (snapshot.tick > 50)
        carried = replace(snapshot, world=replace(snapshot.world, poses=poses))
        recorder.record(TickRecord(snapshot.tick, (), carried, (), (), (), WizardState(), None))
    assert [json.loads(record.json) for record in tape.records] == [{"event": "carried", "robot": 1}]


def test_what_befalls_robots_and_things_is_an_event():
    tape = Tape()
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
