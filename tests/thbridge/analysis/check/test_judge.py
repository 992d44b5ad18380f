"""The judgement as a whole: what is clean, and what is broken beyond reading."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.bags.bags_with_faults import START, Form, clean, content, judged
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.analysis.check import BagTool, FindingSeverity, judge
from thbridge.app.session.broadcast import Broadcast
from thbridge.recording.bag.reading.scan import scan
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.records import MavlinkFrame, VehicleFrame, VehicleState
from thbridge.ros.publisher import TeamPublisher


def test_the_bag_that_faults_are_planted_in_is_clean(tmp_path: Path) -> None:
    judgement = judged(tmp_path, clean())
    assert judgement.findings == ()
    assert (judgement.messages, judgement.seconds, judgement.start_ns) == (92, 2.9, START)


def test_a_recording_of_ours_is_clean(tmp_path: Path) -> None:
    path = tmp_path / "ours.bag"
    with BagWriter(path) as writer:
        recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(2, 120):
            recorder.record(snapshot, records(snapshot.tick))
    judgement = judge(scan(path))
    assert {finding.rule for finding in judgement.findings} <= {"long-array"}
    assert judgement.ok


def test_a_recording_of_vehicles_is_clean(tmp_path: Path) -> None:
    path = tmp_path / "ours.bag"
    with BagWriter(path) as writer:
        recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD, vehicles=True), SESSION, arena(), [writer])
        for snapshot in snapshots(2, 120):
            heard = MavlinkFrame("/dev/ttyACM0", 253, 0, 0, 7, 255, 190, 0, 11100, bytes(9))
            frames = [VehicleFrame(robot, True, heard) for robot in range(2 if snapshot.tick % 50 == 0 else 0)]
            state = VehicleState(0, True, False, False, False, "HOLD", 4)
            recorder.record(snapshot, [*frames, *([state] if frames else [])])
    assert {finding.rule for finding in judge(scan(path)).findings} <= {"long-array"}


@pytest.mark.parametrize("ros_order", [False, True])
def test_heads_are_read_in_either_order(tmp_path: Path, ros_order: bool) -> None:
    assert judged(tmp_path, clean(), ros_order=ros_order).messages == 92


def test_verdict_of_each_tool(tmp_path: Path) -> None:
    planted = clean()
    planted.drop("/tf_static")
    judgement = judged(tmp_path, planted)
    assert judgement.worst(BagTool.RVIZ) is FindingSeverity.ERROR
    assert judgement.worst(BagTool.ROSBAG) is None
    assert not judgement.ok


CLEAN = content(clean(), Form(chunk_bytes=20000))


@given(
    st.lists(st.tuples(st.integers(13, len(CLEAN) - 1), st.binary(min_size=1, max_size=6)), min_size=1, max_size=8),
    st.integers(1, len(CLEAN)),
)
@settings(max_examples=80, deadline=None)
def test_damage_never_ends_in_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, cuts: list[tuple[int, bytes]], keep: int
) -> None:
    data = bytearray(CLEAN)
    for at, change in cuts:
        data[at : at + len(change)] = change
    path = tmp_path_factory.getbasetemp() / "damaged.bag"
    path.write_bytes(bytes(data[: max(keep, 13)]))
    judge(scan(path))
