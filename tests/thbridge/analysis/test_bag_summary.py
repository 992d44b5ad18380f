from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.bags.bags_with_faults import ODOM_LINE, START, STEP, Entry, Planted, clean, odom_message, write
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, snapshots
from thbridge.analysis.bag_summary import RecordingSummary, TopicSummary, summarise
from thbridge.app.session.broadcast import Broadcast
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.publisher import TeamPublisher


def topic(summary: RecordingSummary, name: str) -> TopicSummary:
    return next(topic for topic in summary.topics if topic.name == name)


def test_topics(tmp_path: Path) -> None:
    summary = summarise(write(tmp_path / "a.bag", clean()))
    assert topic(summary, "/odom") == TopicSummary(
        name="/odom",
        msgtype="nav_msgs/Odometry",
        md5=plain_definition("nav_msgs/Odometry").md5,
        messages=30,
        latched=False,
        callers=("/robot",),
        hertz=pytest.approx(10.0),
        start_ns=START,
        end_ns=START + 29 * STEP,
        gaps=(),
    )
    assert topic(summary, "/map").latched
    assert (summary.messages, summary.duration, summary.compression) == (92, 2.9, "none")
    assert summary.session is None


def test_a_silence_of_what_speaks_regularly_is_a_gap(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.append(Entry(ODOM_LINE, START + 60 * STEP, odom_message(START)))
    (gap,) = topic(summarise(write(tmp_path / "a.bag", planted)), "/odom").gaps
    assert (gap.start_ns, gap.seconds) == (START + 29 * STEP, 3.1)


def test_what_speaks_now_and_then_has_no_gaps(tmp_path: Path) -> None:
    times = [second**2 * 1_000_000_000 for second in range(1, 30)]
    planted = Planted([Entry(ODOM_LINE, START + ns, odom_message(START)) for ns in times])
    assert topic(summarise(write(tmp_path / "a.bag", planted)), "/odom").gaps == ()


def test_what_is_latched_has_no_gaps(tmp_path: Path) -> None:
    latched = replace(ODOM_LINE, latching="1")
    times = [*range(30), 60]
    planted = Planted([Entry(latched, START + time * STEP, odom_message(START)) for time in times])
    assert topic(summarise(write(tmp_path / "a.bag", planted)), "/odom").gaps == ()


def test_bursts_have_no_gaps(tmp_path: Path) -> None:
    times = [burst * 10_000_000_000 + index * 10_000_000 for burst in range(5) for index in range(20)]
    planted = Planted([Entry(ODOM_LINE, START + ns, odom_message(START)) for ns in times])
    assert topic(summarise(write(tmp_path / "a.bag", planted)), "/odom").gaps == ()


def test_parts_are_summed_up_together(tmp_path: Path) -> None:
    planted = clean()
    write(tmp_path / "a_0.bag", Planted(planted.entries[:50]))
    write(tmp_path / "a_1.bag", Planted(planted.entries[50:]))
    summary = summarise(tmp_path / "a.bag")
    assert [part.messages for part in summary.parts] == [50, 42]
    assert (summary.messages, summary.duration) == (92, 2.9)
    assert topic(summary, "/odom").messages == 30


def test_the_session_of_a_recording_of_ours(tmp_path: Path) -> None:
    path = tmp_path / "ours.bag"
    with BagWriter(path) as writer:
        recorder = Broadcast(TeamPublisher(1, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(1, 10):
            recorder.record(snapshot)
    session = summarise(path).session
    assert session is not None
    assert (session.seed, session.versions, session.study) == (SESSION.seed, SESSION.versions, SESSION.study)
