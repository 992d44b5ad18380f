"""`rosbag play` of what vehicles once heard drives the robots of a session that is on a ROS graph."""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.peers.ros_programs import NEEDS_ROS, Ros
from tests.support.hunts.recorded_hunts import replay_again
from tests.support.mavlink.recorded_stations import Tour, record
from tests.support.programs.ports import free_port, free_udp_port
from tests.support.programs.processes import Program, until
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.repair import reindex
from thbridge.ros.messages import unpack
from thbridge.ros.messages.records import MavlinkFrame

pytestmark = NEEDS_ROS

TOPICS = ("/robot1/mavlink/to", "/robot2/mavlink/to")


def frames_in(bag: Path) -> dict[str, list[MavlinkFrame]]:
    """What each robot heard; ROS keeps the order within a topic alone."""
    return {topic: [unpack.mavlink(message.data) for message in messages(bag, [topic])] for topic in TOPICS}


def frames_so_far(recording: Path) -> int:
    """How many frames are in the file of a recording under way."""
    with TemporaryDirectory() as folder:
        copy = Path(shutil.copy(recording, folder))
        return sum(map(len, frames_in(reindex(copy).path).values()))


@pytest.mark.slow
def test_rosbag_play_sets_robots_off(tmp_path: Path) -> None:
    record(tmp_path / "was.bag", 120, Tour({1: [5], 2: [4]}))
    port = free_port()
    alone = ("--headless", "--outside", "TabUI", "--port", "0", "--bag", "now.bag", "--no-report")
    graph = ("--ros", "--ros-master", f"http://127.0.0.1:{port}")
    play = Program(tmp_path, "play", "--mavlink", "--udp", f"127.0.0.1:{free_udp_port()}", *alone, *graph)
    try:
        until("the session to be on the graph", lambda: "this program is the master" in play.text, [play])
        ros = Ros(port, tmp_path)
        ros.says("rostopic", "echo", "-n", "1", "/robot1/odom/header/seq")
        was = frames_in(tmp_path / "was.bag")
        # A player that ends by itself takes with it what it has not sent yet.
        player = ("rosbag", "play", "-q", "--keep-alive", "--wait-for-subscribers", str(tmp_path / "was.bag"))
        with ros.running(*player, "--topics", *TOPICS):
            until("the robots to set out", lambda: all(f"for room {room}" in play.text for room in (4, 5)), [play])
            count = sum(map(len, was.values()))
            until("all frames to be recorded", lambda: frames_so_far(tmp_path / "now.bag.active") >= count, [play])
        assert play.stop() == 1
    finally:
        play.close()
    for topic, now in frames_in(tmp_path / "now.bag").items():
        assert {frame.link for frame in now} == {"ros"}
        frames = [(frame.sequence, frame.message_id, frame.payload) for frame in now]
        assert frames == [(frame.sequence, frame.message_id, frame.payload) for frame in was[topic]]
    done = replay_again(tmp_path / "now.bag")
    assert done.finished
    assert done.difference is None
