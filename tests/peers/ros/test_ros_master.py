"""ROS 1's own nodes and tools, in Python and in C++, find each other through our master."""

import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.programs import processes
from tests.support.programs.peer_programs import run_peer, skipping_if_crashed

PYTHON = "/usr/bin/python3"
TOOLS = ("rostopic", "rosnode", "rosparam", "rosservice", "rosbag", "roslaunch", "roswtf")
pytestmark = pytest.mark.skipif(
    any(shutil.which(tool) is None for tool in TOOLS),
    reason=f"not installed: {', '.join(TOOLS)} (see scripts/install_peers.sh)",
)
PATIENCE = 120.0

NAMED_TALKER = """
import rospy, sys
from std_msgs.msg import String
rospy.init_node("named")
publisher = rospy.Publisher("/words", String, queue_size=1)
rate = rospy.Rate(50)
try:
    while not rospy.is_shutdown():
        publisher.publish(sys.argv[1])
        rate.sleep()
except rospy.ROSException:  # told to end in the middle of publishing or sleeping
    pass
"""

LOGGER = """
import rospy
rospy.init_node("logger")
while not rospy.is_shutdown():
    rospy.logwarn("mind the gap")
    rospy.sleep(0.2)
"""


class Running:
    """A program of ROS under way; what it says goes to a file."""

    def __init__(self, process: subprocess.Popen[bytes], output: Path) -> None:
        self.process = process
        self.output = output

    @property
    def text(self) -> str:
        return self.output.read_text(errors="replace")


class Graph:
    """Our master, and ROS's programs at it."""

    def __init__(self, uri: str, folder: Path) -> None:
        self.uri = uri
        self.folder = folder

    def environment(self) -> dict[str, str]:
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "ROS_"))}
        home = {"ROS_HOME": str(self.folder), "ROS_LOG_DIR": str(self.folder / "log")}
        return {**kept, **home, "ROS_MASTER_URI": self.uri, "ROS_IP": "127.0.0.1", "PYTHONUNBUFFERED": "1"}

    def says(self, *command: str, typed: str = "", status: int = 0) -> str:
        """All that a command has to say."""
        done = run_peer(command, env=self.environment(), cwd=self.folder, input=typed, timeout=PATIENCE)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout

    @contextmanager
    def running(self, *command: str) -> Iterator[Running]:
        output = self.folder / f"{time.monotonic_ns()}.txt"
        with output.open("wb") as opened:
            process = subprocess.Popen(
                command, env=self.environment(), cwd=self.folder, stdin=subprocess.DEVNULL, stdout=opened,
                stderr=subprocess.STDOUT, start_new_session=True,
            )  # fmt: skip
        try:
            with skipping_if_crashed(command[0], process):
                yield Running(process, output)
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            try:
                process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def talker(self, topic: str) -> object:
        return self.running("rostopic", "pub", "-r", "50", topic, "std_msgs/String", "data: hello")

    def node_of(self, topic: str) -> str:
        """The name of the one node that publishes a topic."""
        eventually(lambda: f"* {topic} " in self.says("rostopic", "list", "-v"), f"{topic} to be published")
        [node] = [line for line in self.says("rostopic", "info", topic).splitlines() if line.startswith(" * ")]
        return node.split()[1]


def eventually(condition: Callable[[], object], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.1)


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Graph]:
    folder = tmp_path_factory.mktemp("ros")
    master = processes.Program(folder, "ros", "master", "--port", "0")
    try:
        port = processes.port_of(master, [master])
        yield Graph(f"http://localhost:{port}", folder)
        assert master.stop() == 0
        assert "Traceback" not in master.text
    finally:
        master.close()


def test_topics(graph):
    with graph.talker("/chat"):
        assert graph.says("rostopic", "echo", "-n", "3", "/chat").count('data: "hello"') == 3
        assert "/chat" in graph.says("rostopic", "list").splitlines()
        assert graph.says("rostopic", "type", "/chat") == "std_msgs/String\n"
        with graph.running("rostopic", "hz", "/chat") as hz:
            # The talker's pace is its own, and a busy machine's.
            eventually(lambda: re.search(r"average rate: [1-9].*\n.*window: \d\d", hz.text), "its rate")


@pytest.mark.slow
def test_parameters(graph):
    written = graph.folder / "given.yaml"
    written.write_text("{speed: 0.5, name: 'a & <b> é', flags: [true, 3], deep: {er: {est: -1}}}\n")
    graph.says("rosparam", "load", str(written), "/robot1")
    assert graph.says("rosparam", "get", "/robot1/deep/er/est") == "-1\n"
    graph.says("rosparam", "set", "/robot1/speed", "0.75")
    assert graph.says("rosparam", "get", "/robot1/speed") == "0.75\n"
    listed = graph.says("rosparam", "list", "/robot1").split()
    assert sorted(listed) == [f"/robot1/{key}" for key in ("deep/er/est", "flags", "name", "speed")]
    graph.says("rosparam", "dump", str(graph.folder / "dump.yaml"), "/robot1")
    graph.says("rosparam", "delete", "/robot1")
    graph.says("rosparam", "get", "/robot1", status=1)
    graph.says("rosparam", "load", str(graph.folder / "dump.yaml"), "/again")
    assert "a & <b>" in graph.says("rosparam", "get", "/again/name")


def test_nodes_and_services(graph):
    with graph.talker("/nodes"):
        node = graph.node_of("/nodes")
        assert node in graph.says("rosnode", "list").split()
        assert "* /nodes [std_msgs/String]" in graph.says("rosnode", "info", node)
        assert "xmlrpc reply" in graph.says("rosnode", "ping", "-c", "1", node)
        assert f"{node}/get_loggers" in graph.says("rosservice", "list").split()
        assert graph.says("rosservice", "node", f"{node}/get_loggers") == f"{node}\n"
        assert "loggers" in graph.says("rosservice", "call", f"{node}/get_loggers")
        graph.says("rosnode", "kill", node)
        eventually(lambda: node not in graph.says("rosnode", "list").split(), "the node to be gone")


@pytest.mark.slow
def test_a_killed_node_is_cleaned_up(graph):
    with graph.talker("/doomed") as talker:
        node = graph.node_of("/doomed")
        talker.process.kill()
        talker.process.wait()
        assert node in graph.says("rosnode", "list").split()
        graph.says("rosnode", "cleanup", typed="y\n")
        assert node not in graph.says("rosnode", "list").split()


@pytest.mark.slow
def test_a_node_of_the_same_name_takes_over_and_its_subscribers_go_on(graph):
    with graph.running("rostopic", "echo", "/words") as echo:
        with graph.running(PYTHON, "-c", NAMED_TALKER, "first") as first:
            eventually(lambda: '"first"' in echo.text, "the first to be heard")
            with graph.running(PYTHON, "-c", NAMED_TALKER, "second") as second:
                assert first.process.wait(PATIENCE) == 0  # told to end
                eventually(lambda: '"second"' in echo.text, "the second to be heard")
                second.process.kill()  # and restarted after a sudden death
        with graph.running(PYTHON, "-c", NAMED_TALKER, "third"):
            eventually(lambda: '"third"' in echo.text, "the third to be heard")


@pytest.mark.slow
def test_recording_and_playing(graph):
    """rosbag's record and play are C++ nodes."""
    with graph.talker("/tape"):
        graph.says("rosbag", "record", "--limit=20", "-O", "tape.bag", "/tape")
    assert "/tape" in graph.says("rosbag", "info", "tape.bag")
    with graph.running("rostopic", "echo", "-n", "3", "/tape") as echo:
        eventually(lambda: "/tape" in graph.says("rostopic", "list", "-s"), "the subscriber")
        graph.says("rosbag", "play", "--quiet", "--wait-for-subscribers", "tape.bag")
        eventually(lambda: echo.text.count('data: "hello"') == 3, "three messages played")


def test_roslaunch_joins(graph):
    (graph.folder / "one.launch").write_text(
        '<launch><param name="launched/x" value="7"/>'
        '<node name="bound" pkg="rosservice" type="rosservice" args="list"/></launch>'
    )
    graph.says("roslaunch", "--skip-log-check", "one.launch")
    assert graph.says("rosparam", "get", "/launched/x") == "7\n"


@pytest.mark.slow
def test_roswtf_finds_nothing_wrong_with_the_graph(graph):
    with graph.talker("/healthy"):
        graph.node_of("/healthy")
        online = graph.says("roswtf").partition("Beginning tests of your ROS graph")[2]
    assert "graph rules" in online and "ERROR" not in online


@pytest.mark.slow
def test_what_nodes_log_is_said_again_on_one_topic(graph):
    with graph.running("rostopic", "echo", "/rosout_agg/msg") as echo, graph.running(PYTHON, "-c", LOGGER):
        eventually(lambda: "mind the gap" in echo.text, "the warning")
