"""What watching costs: any moment of a ten-minute recording, all of it once, and ten robots live."""

import random
import time
from collections.abc import Generator
from pathlib import Path

import numpy as np
import pytest

from tests.bench.budget import Budgets, best
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.ros.messages import types
from thbridge.ros.publisher import RosMessage, TeamPublisher
from thbridge.watching.wire import SessionMessage
from ui.model.watching.live import LiveSource
from ui.model.watching.scene import ShownLayers
from ui.sources.bag import BagSource, open_bag

pytestmark = pytest.mark.bench

ALL = ShownLayers(selected=0, global_costmap=True, local_costmap=True)
FRAME_NS = 1_000_000_000 // 60


def session(robots: int, seconds: int) -> list[RosMessage]:
    publisher = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
    messages = publisher.opening(0, SESSION, arena())
    for snapshot in snapshots(robots, 50 * seconds):
        messages += publisher.tick(snapshot, records(snapshot.tick))
    return messages


def record(path: Path, messages: list[RosMessage], times: int) -> None:
    """The messages again and again, each time later."""
    file, known = BagFile(path), dict[str, BagConnection]()
    span = messages[-1].stamp_ns - messages[0].stamp_ns + 20_000_000
    for turn in range(times):
        for topic, stamp_ns, data, _ in messages:
            if topic.name not in known:
                definition = types.plain_definition(topic.msgtype)
                known[topic.name] = file.connect(
                    topic.name, topic.msgtype, definition.md5, definition.text, "/bench", topic.latched
                )
            file.write(known[topic.name], stamp_ns + turn * span, data)
    file.close()


def opened(path: Path) -> BagSource:
    work: Generator[float, None, BagSource] = open_bag(path)
    while True:
        try:
            next(work)
        except StopIteration as done:
            assert isinstance(done.value, BagSource)
            return done.value


def test_any_moment_of_ten_minutes(tmp_path: Path, budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "long.bag"
    record(path, session(3, 60), 10)
    opening, source = best(lambda: opened(path), 3), opened(path)
    seeks, pieces, frames = [], [], []
    chance = random.Random(1)
    for _ in range(200):
        began = time.process_time()
        source.scene(chance.randrange(source.start_ns, source.end_ns), ALL)
        seeks.append(time.process_time() - began)
    began = time.process_time()
    for _ in source.scan():
        pieces.append(time.process_time() - began)
        began = time.process_time()
    for frame in range(1200):
        began = time.process_time()
        source.scene(source.start_ns + 100_000_000_000 + frame * FRAME_NS, ALL)
        frames.append(time.process_time() - began)
    with capsys.disabled():
        size = path.stat().st_size / 1e6
        print(f"\nrecording of 3 robots, {(source.end_ns - source.start_ns) / 1e9:.0f} s, {size:.0f} MB")
        print(f"  opened in {1e3 * opening:.0f} ms")
        print(f"  any moment: {1e3 * np.mean(seeks):.1f} ms, at most {1e3 * max(seeks):.1f} ms")
        print(f"  all of it: {sum(pieces):.2f} s, in pieces of at most {1e3 * max(pieces):.1f} ms")
        print(f"  played, a frame: {1e3 * np.mean(frames):.2f} ms, at most {1e3 * max(frames):.1f} ms")
    budgets.time("watching a recording: opening", opening)
    budgets.time("watching a recording: any moment", float(np.mean(seeks)))
    budgets.time("watching a recording: all of it", sum(pieces))
    budgets.time("watching a recording: a frame while it plays", float(np.mean(frames)))


def test_ten_robots_live(budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    seconds = 20
    said = [SessionMessage(topic.name, topic.msgtype, stamp, data) for topic, stamp, data, _ in session(10, seconds)]
    source, taking, drawing, at = LiveSource(), 0.0, 0.0, 0
    for frame in range(seconds * 60):
        limit = said[0].stamp_ns + frame * FRAME_NS
        end = at
        while end < len(said) and said[end].stamp_ns <= limit:
            end += 1
        began = time.process_time()
        source.take(said[at:end], frame / 60)
        taken = time.process_time()
        source.scene(ALL)
        taking, drawing, at = taking + taken - began, drawing + time.process_time() - taken, end
    with capsys.disabled():
        print(f"\n10 robots live, {len(said) / seconds:.0f} messages/s, 60 scenes/s")
        print(f"  taking {100 * taking / seconds:.1f} % of a core ({1e6 * taking / len(said):.1f} us a message)")
        print(f"  scenes {100 * drawing / seconds:.1f} % of a core ({1e3 * drawing / seconds / 60:.2f} ms a scene)")
    budgets.time("watching live: a second's messages of 10 robots", taking / seconds)
    budgets.time("watching live: a scene of 10 robots", drawing / seconds / 60)
