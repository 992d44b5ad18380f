"""Our judgement of bags is judged: where ROS 1's own tools stumble over a planted fault, we said so."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from sim.common.geometry import IDENTITY
from tests.support.bags.bags_with_faults import (
    SCAN_LINE,
    START,
    STATIC_LINE,
    Entry,
    Planted,
    clean,
    found,
    scan_message,
    tf,
    write,
)
from tests.support.bags.foreign_bags import transform
from tests.support.programs.peer_programs import run_peer
from thbridge.analysis.check import FindingSeverity, Judgement, judge
from thbridge.analysis.cut import CutRange, cut
from thbridge.recording.bag.options import ROS1_COMPRESSIONS, Compression
from thbridge.recording.bag.reading.scan import scan
from thbridge.ros.messages.types import plain_definition

PYTHON = "/usr/bin/python3"
needs_ros = pytest.mark.skipif(shutil.which("rosbag") is None, reason="not installed: python3-rosbag")
pytestmark = needs_ros


def run(*command: str) -> subprocess.CompletedProcess[str]:
    kept = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")}
    return run_peer(command, env=kept, timeout=60)


def info(path: Path) -> str:
    done = run("rosbag", "info", "--yaml", str(path))
    return done.stdout + done.stderr


READ = """
import sys, rosbag
with rosbag.Bag(sys.argv[1]) as bag:
    print(sum(1 for _ in bag.read_messages()))
"""


def read(path: Path) -> str:
    """What the Python reader says: the number of messages, or its complaint."""
    done = run(PYTHON, "-c", READ, str(path))
    return done.stdout + done.stderr


def judgement_of(path: Path) -> Judgement:
    return judge(scan(path))


def test_the_clean_bag_is_clean_to_rosbag(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", clean())
    assert read(path).strip() == "92"
    assert "duration: 2.900000" in info(path)
    assert judgement_of(path).findings == ()


def test_missing_index(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", clean(), indexed=False)
    assert "unindexed" in info(path)
    assert found(judgement_of(path), "no-index")


@pytest.mark.parametrize("form", [{"reverse_chunks": True}, {"empty_chunk": True}])
def test_durations_that_rosbag_gets_wrong(tmp_path: Path, form: dict[str, bool]) -> None:
    path = write(tmp_path / "a.bag", clean(), **form)
    told = re.search(r"duration: (-?[0-9.]+)", info(path))
    assert told is not None
    assert float(told[1]) < 0.0
    assert f"reports {float(told[1]):.1f} s" in found(judgement_of(path), "chunk-order").what


def test_a_first_record_that_reindex_overruns(tmp_path: Path) -> None:
    for padded_to, survives in ((4096, True), (4088, False)):
        path = write(tmp_path / f"{padded_to}.bag", clean(), padded_to=padded_to, indexed=False)
        rules = {finding.rule for finding in judgement_of(path).findings}
        run("rosbag", "reindex", "--quiet", str(path))
        assert (read(path).strip() == "92") is survives
        assert ("header-padding" in rules) is not survives


def test_wrong_md5(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/odom", md5="0" * 32)
    path = write(tmp_path / "a.bag", planted)
    complaint = read(path)
    assert "does not match message definition" in complaint
    told = re.search(r"definition \[([0-9a-f]{32})\]", complaint)
    assert told is not None
    assert told[1] in found(judgement_of(path), "md5-wrong").what


def test_definition_without_nested_types(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/odom", definition=plain_definition("nav_msgs/Odometry").text.partition("=" * 80)[0])
    path = write(tmp_path / "a.bag", planted)
    assert "MsgNotFound" in read(path)
    assert found(judgement_of(path), "definition-missing")


@pytest.mark.parametrize("cut_off", [3, 400])
def test_data_that_end_too_early(tmp_path: Path, cut_off: int) -> None:
    planted = clean()
    last = planted.entries[-1]
    planted.entries[-1] = Entry(last.line, last.ns, data=last.bytes()[:-cut_off])
    path = write(tmp_path / "a.bag", planted)
    assert "DeserializationError" in read(path)
    assert found(judgement_of(path), "data-wrong")


@pytest.mark.parametrize("content_checksum", [True, False])
def test_lz4(tmp_path: Path, content_checksum: bool) -> None:
    flags = {"block_linked": False, "store_size": False, "content_checksum": content_checksum}
    path = write(tmp_path / "a.bag", clean(), lz4_flags=flags)
    assert (read(path).strip() == "92") is content_checksum
    assert ("lz4-frames" in {finding.rule for finding in judgement_of(path).findings}) is not content_checksum


TF = """
import sys, rosbag, rospy, tf2_py
buffer = tf2_py.BufferCore(rospy.Duration(1000))
frames = set()
with rosbag.Bag(sys.argv[1]) as bag:
    for topic, message, _ in bag.read_messages():
        if topic in ("/tf", "/tf_static"):
            for transform in message.transforms:
                (buffer.set_transform_static if topic == "/tf_static" else buffer.set_transform)(transform, "bag")
        elif hasattr(message, "header"):
            frames.add((topic, message.header.frame_id))
for topic, frame in sorted(frames):
    try:
        buffer.lookup_transform_core("map", frame, rospy.Time(0))
    except Exception as error:
        print(topic, type(error).__name__)
"""


def _bad_rotation(*parts: float) -> Planted:
    planted = clean()
    message = planted.of("/tf_static")[0].message
    rotation = message.transforms[0].transform.rotation  # type: ignore[attr-defined]
    rotation.x, rotation.y, rotation.z, rotation.w = parts
    return planted


def _slash() -> Planted:
    planted = clean()
    planted.entries = [
        Entry(SCAN_LINE, entry.ns, scan_message(entry.ns, "/laser")) if entry.line.topic == "/scan" else entry
        for entry in planted.entries
    ]
    return planted


def _static_missing() -> Planted:
    planted = clean()
    planted.drop("/tf_static")
    return planted


def _self_transform() -> Planted:
    planted = _static_missing()
    planted.entries.insert(0, Entry(STATIC_LINE, START, tf(transform(START, "laser", "laser", IDENTITY))))
    return planted


@pytest.mark.parametrize(
    ("planted", "rule"),
    [
        (_bad_rotation(0.0, 0.0, 0.0, 1.006), "quaternion"),
        (_bad_rotation(0.0, 0.0, 0.0, 0.0), "quaternion"),
        (_bad_rotation(0.0, 0.0, 0.0, float("nan")), "quaternion"),
        (_slash(), "frame-slash"),
        (_static_missing(), "tf-missing"),
        (_self_transform(), "tf-names"),
    ],
)
def test_what_tf2_cannot_look_up(tmp_path: Path, planted: Planted, rule: str) -> None:
    path = write(tmp_path / "a.bag", planted)
    assert run(PYTHON, "-c", TF, str(path)).stdout.split()[0] == "/scan"
    assert found(judgement_of(path), rule).severity is FindingSeverity.ERROR


def test_what_tf2_just_takes_we_take(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", _bad_rotation(0.0, 0.0, 0.0, 1.004))
    assert run(PYTHON, "-c", TF, str(path)).stdout == ""
    assert judgement_of(path).findings == ()


WRITE = """
import sys, rosbag, rospy
from std_msgs.msg import String
with rosbag.Bag(sys.argv[1], "w", compression=sys.argv[2]) as bag:
    for second in range(1, 300):
        bag.write("/chatter", String("hello " * 100), rospy.Time(second))
"""


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_what_rosbag_writes_is_clean_to_us(tmp_path: Path, compression: str) -> None:
    path = tmp_path / "theirs.bag"
    assert run(PYTHON, "-c", WRITE, str(path), compression).returncode == 0
    judgement = judgement_of(path)
    assert {finding.rule for finding in judgement.findings} == {"no-trajectory"}
    assert judgement.messages == 299


@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_what_we_cut_is_whole_to_rosbag(tmp_path: Path, compression: Compression) -> None:
    source = write(tmp_path / "a.bag", clean())
    done = cut(source, CutRange(1.0, 2.0, compression=compression), tmp_path / "b.bag")
    assert read(done.path).strip() == str(done.messages)
    assert "duration: 1.000000" in info(done.path)
