"""Messages of several ticks that are made together are those of the single ticks, and none is lost."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.robot.costmap.view import CostmapView, ShownCostmap
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.bags.inline_queue import InlineQueue
from thbridge.app.session.broadcast import HELD_TICKS, Broadcast
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import HOLD_SECONDS, BagWriter
from thbridge.ros.publisher import RosMessage, TeamPublisher

TICKS = 2 * HELD_TICKS + 3
ROBOTS = 2


class Prompt:
    """Listener that needs each tick at once."""

    def __init__(self) -> None:
        self.ticks: list[int] = []
        self.messages: list[RosMessage] = []

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        self.ticks.append(tick)
        self.messages += messages


class Patient(Prompt):
    """Listener that waits."""

    is_due = False

    def fetch_with(self, fetch: Callable[[], None]) -> None:
        self.fetch = fetch


def broadcast(*listeners: Prompt | BagWriter) -> Broadcast:
    return Broadcast(TeamPublisher(ROBOTS, MOUNT, SCAN_PERIOD), SESSION, arena(), listeners)


def record(recorder: Broadcast, ticks: int = TICKS) -> None:
    for snapshot in snapshots(ROBOTS, ticks):
        recorder.record(snapshot, records(snapshot.tick))


def test_messages_that_are_made_together_are_those_of_each_tick() -> None:
    prompt, patient = Prompt(), Patient()
    record(broadcast(prompt))
    record(broadcast(patient))
    assert patient.ticks == [0, prompt.ticks[HELD_TICKS], prompt.ticks[2 * HELD_TICKS]]
    patient.fetch()
    assert patient.messages == prompt.messages


def test_nothing_waits_if_one_listener_needs_each_tick_at_once() -> None:
    prompt, patient = Prompt(), Patient()
    record(broadcast(prompt, patient))
    assert patient.ticks == prompt.ticks
    assert len(prompt.ticks) == 1 + TICKS


def test_a_due_listener_gets_all_ticks_at_once() -> None:
    patient = Patient()
    recorder = broadcast(patient)
    record(recorder, 3)
    assert len(patient.ticks) == 1
    patient.is_due = True
    (*_, last) = snapshots(ROBOTS, 4)
    recorder.record(last)
    assert patient.ticks[1:] == [last.tick]


def test_a_bag_has_the_held_ticks_after_an_error_of_the_session(tmp_path: Path) -> None:
    prompt, bag = Prompt(), tmp_path / "a.bag"
    record(broadcast(prompt), 5)
    with pytest.raises(ZeroDivisionError), BagWriter(bag, clock=lambda: 0.0) as writer:
        record(broadcast(writer), 5)
        raise ZeroDivisionError
    assert [(m.topic, m.stamp_ns, m.data) for m in messages(bag)] == [
        (m.topic.name, m.stamp_ns, m.data) for m in prompt.messages
    ]


def test_a_bag_lets_no_tick_wait_long(tmp_path: Path) -> None:
    now = 0.0
    with BagWriter(tmp_path / "a.bag", clock=lambda: now, make_queue=lambda _: InlineQueue()) as writer:
        assert not writer.is_due
        now = 0.9 * HOLD_SECONDS
        assert not writer.is_due
        now = 1.1 * HOLD_SECONDS
        assert writer.is_due


def test_costmaps_are_read_before_they_change() -> None:
    patient, read = Patient(), 0
    recorder = broadcast(patient)
    (snapshot, *_) = snapshots(ROBOTS, 1)
    costs = np.zeros((2, 3), dtype=np.uint8)

    def compute() -> CostmapView:
        nonlocal read
        read += 1
        return CostmapView(snapshot.tick, Pose2(0.0, 0.0, 0.0), 0.05, costs)

    shown = ShownCostmap(compute)
    first, *others = snapshot.robots
    robot = replace(first, navigation=replace(first.navigation, local_costmap=shown))
    recorder.record(replace(snapshot, robots=(robot, *others)))
    shown.expire()  # as in the robot's next step
    patient.fetch()
    assert read == 1
    assert "/robot1/move_base/local_costmap/costmap" in {message.topic.name for message in patient.messages}
