"""What goes wrong around a session on a ROS graph: masters die, names are taken, subscribers do not read.

Whatever it is, the hunt goes on at its pace and its recording is complete.
"""

import os
import signal
import socket
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import pytest

from tests.peers.ros import rospy_scripts
from tests.peers.ros_programs import NEEDS_ROS, PATIENCE, PYTHON, Ros
from tests.support.programs.ports import free_port
from tests.support.programs.processes import THBRIDGE, Program, until
from thbridge.recording.bag.reading.reader import messages
from thbridge.rosgraph.wire.tcpros import encode_header

pytestmark = NEEDS_ROS

ELSEWHERE = "127.0.0.2"
"""An address that is not ours to serve at, though what listens everywhere on this machine listens there."""


class Core:
    """Debian's master, which dies as hard as it can and comes back."""

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        self.ros = Ros(self.port, folder)
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        # With an address of its own it would listen on that one only.
        environment = {name: value for name, value in self.ros.environment.items() if name != "ROS_IP"}
        self._process = subprocess.Popen(
            ["rosmaster", "--core", "-p", str(self.port)],
            env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip
        until("the master", self._listens, [])

    def kill(self) -> None:
        if self._process is not None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._process = None

    def _listens(self) -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def nodes(self) -> list[str]:
        return self.ros.says("rosnode", "list").split()

    def parameters(self) -> list[str]:
        return self.ros.says("rosparam", "list").split()

    def whole(self) -> bool:
        """Whether the graph has all that the session says and serves."""
        if "/thbridge" not in self.nodes():
            return False
        told = self.ros.says("rosnode", "info", "/thbridge")
        return all(name in told for name in ("/robot2/scan [", "/robot2/move_base/goal [", "/robot2/set_pose"))


@pytest.fixture
def core(tmp_path: Path) -> Iterator[Core]:
    made = Core(tmp_path)
    yield made
    made.kill()


@contextmanager
def hunt(folder: Path, uri: str, *arguments: str) -> Iterator[Program]:
    """A hunt that a simulated participant plays, on a graph."""
    started = ("play", "--headless", "--participant", "suggestion", "--ros", "--ros-master", uri)
    program = Program(folder, *started, "--port", "0", "--bag", "hunt.bag", "--no-report", *arguments)
    try:
        yield program
    finally:
        program.close()


def under_way(program: Program) -> None:
    until("the hunt", lambda: "leaves for" in program.text, [program])


def ends_well(program: Program, folder: Path) -> None:
    """Whether it stops when it is told to, with a bag from its first tick to its last."""
    assert program.stop() == 1, program.text
    assert "The recording is complete up to this point" in program.text
    assert "Traceback" not in program.text
    ticks = [message.stamp_ns for message in messages(folder / "hunt.bag") if message.topic == "/robot1/odom"]
    assert len(ticks) > 50
    assert {later - earlier for earlier, later in pairwise(ticks)} == {20_000_000}


def recorded(folder: Path) -> int:
    """How long the recording is, finished or not."""
    return sum(file.stat().st_size for file in folder.glob("hunt.bag*"))


def goes_on(program: Program, folder: Path) -> None:
    before = recorded(folder)
    until("the recording to go on", lambda: recorded(folder) > before + 200_000, [program])
    assert program.process.poll() is None


@pytest.mark.slow
def test_a_master_that_comes_late_dies_and_comes_again_is_told_everything(core: Core, tmp_path: Path) -> None:
    with hunt(tmp_path, f"http://{ELSEWHERE}:{core.port}") as program:
        under_way(program)
        assert "there is no master yet" in program.text
        core.start()
        until("everything at the late master", core.whole, [program])
        for _ in range(2):
            assert {"/use_sim_time", "/robot1/amcl/max_particles", "/thbridge/seed"} <= {*core.parameters()}
            core.ros.says("rostopic", "echo", "-n", "1", "/robot1/odom/header/seq")
            core.ros.says("rostopic", "echo", "-n", "1", "/map/info/width")
            core.kill()
            goes_on(program, tmp_path)
            core.start()
            until("everything at the next master", core.whole, [program])
        ends_well(program, tmp_path)


@pytest.mark.slow
def test_a_subscriber_hears_on_while_the_master_is_dead(core: Core, tmp_path: Path) -> None:
    core.start()
    with (
        hunt(tmp_path, f"http://127.0.0.1:{core.port}") as program,
        core.ros.running("rostopic", "echo", "-p", "/robot1/odom/header/seq") as subscriber,
    ):
        assert subscriber.stdout is not None
        under_way(program)
        subscriber.stdout.readline()
        core.kill()
        for _ in range(200):
            assert subscriber.stdout.readline()
        core.start()
        for _ in range(200):
            assert subscriber.stdout.readline()
        until("everything at the new master", core.whole, [program])


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_whoever_stops_a_session_finds_the_graph_in_order(core: Core, tmp_path: Path, number: signal.Signals) -> None:
    core.start()
    before = core.parameters()
    with hunt(tmp_path, f"http://127.0.0.1:{core.port}") as program:
        under_way(program)
        until("everything at the master", core.whole, [program])
        os.killpg(program.process.pid, number)
        assert program.process.wait(PATIENCE) == 1
        assert "complete" in program.text
        assert "Traceback" not in program.text
    assert core.nodes() == []
    assert core.parameters() == before
    assert core.ros.says("rostopic", "list").split() == []


@pytest.mark.slow
def test_rosnode_kill_ends_the_sitting_and_not_the_hunt(core: Core, tmp_path: Path) -> None:
    core.start()
    with hunt(tmp_path, f"http://127.0.0.1:{core.port}") as program:
        under_way(program)
        until("everything at the master", core.whole, [program])
        core.ros.says("rosnode", "kill", "/thbridge")
        until("the graph to be empty", lambda: "/thbridge" not in core.nodes(), [program])
        until("the session to tell", lambda: "goes on without it" in program.text, [program])
        goes_on(program, tmp_path)
        assert core.nodes() == []
        ends_well(program, tmp_path)


@pytest.mark.slow
def test_a_node_of_the_same_name_ends_the_sitting_and_keeps_the_name(core: Core, tmp_path: Path) -> None:
    core.start()
    with hunt(tmp_path, f"http://127.0.0.1:{core.port}") as program:
        under_way(program)
        until("everything at the master", core.whole, [program])
        with core.ros.running(PYTHON, "-c", rospy_scripts.NAMESAKE, "thbridge") as namesake:
            assert namesake.stdout is not None
            assert namesake.stdout.readline() == "here\n"
            until("the session to leave", lambda: "goes on without it" in program.text, [program])
            until("its topics to go", lambda: "/robot1/odom" not in core.ros.says("rostopic", "list"), [program])
            goes_on(program, tmp_path)
            assert core.nodes() == ["/thbridge"]
            assert namesake.poll() is None
            ends_well(program, tmp_path)
            assert core.nodes() == ["/thbridge"]


@pytest.mark.slow
def test_a_master_that_never_answers_does_not_hold_up_a_hunt(tmp_path: Path) -> None:
    with socket.create_server((ELSEWHERE, 0)) as silent:
        uri = f"http://{ELSEWHERE}:{silent.getsockname()[1]}"
        with hunt(tmp_path, uri, "--rate", "0", "--max-seconds", "30") as program:
            assert program.process.wait(120) == 1
            assert "did not end within 30 simulated seconds" in program.text
            assert "Traceback" not in program.text
    assert recorded(tmp_path) > 1_000_000


def refused(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        [*THBRIDGE, "play", "--headless", "--participant", "suggestion", "--port", "0", "--ros", *arguments],
        cwd=folder, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert not [found for found in folder.rglob("*") if found.is_file()]
    return done.stderr


@pytest.mark.slow
def test_a_port_that_something_else_has_is_told_before_anything_begins(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        said = refused(tmp_path, "--ros-master", f"http://127.0.0.1:{taken.getsockname()[1]}")
    assert "Address already in use" in said


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--ros-master", "localhost"), "'localhost' is not the address of a ROS master"),
        pytest.param(("--ros-host", "192.0.2.1"), "192.0.2.1", marks=pytest.mark.slow),
        pytest.param(("--ros-host", "no such host"), "no such host", marks=pytest.mark.slow),
    ],
)
def test_addresses_that_cannot_be_are_told_before_anything_begins(
    tmp_path: Path, arguments: Sequence[str], word: str
) -> None:
    master = () if "--ros-master" in arguments else ("--ros-master", f"http://127.0.0.1:{free_port()}")
    assert word in refused(tmp_path, *arguments, *master)


def stalled(api: tuple[str, int], topics: Sequence[str]) -> list[socket.socket]:
    """Subscribers that do not read a byte."""
    found = []
    for topic in topics:
        one = socket.socket()
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        one.connect(api)
        one.sendall(encode_header({"callerid": "/stalled", "md5sum": "*", "topic": topic, "type": "*"}))
        found.append(one)
    return found


@pytest.mark.slow
def test_subscribers_that_never_read_or_have_the_wrong_type_cost_others_nothing(core: Core, tmp_path: Path) -> None:
    core.start()
    # Ten robots, haste and no end, for a socket takes some megabytes before it is full.
    team = ("--robots", "10", "--map", "warehouse12", "--rate", "8", "--outside", "TabUI")
    with hunt(tmp_path, f"http://127.0.0.1:{core.port}", *team) as program:
        until("everything at the master", core.whole, [program])
        where = core.ros.script(rospy_scripts.WHERE, "/thbridge", "/tf")
        assert isinstance(where, list)
        silent = stalled((where[0], where[1]), ["/tf", "/robot1/odom"])
        with core.ros.running(PYTHON, "-c", rospy_scripts.OF_ANOTHER_TYPE):
            numbers = core.ros.script(rospy_scripts.UNBROKEN, "1500")
            until(
                "the stalled one to lose messages", lambda: "/stalled reads /tf too slowly" in program.text, [program]
            )
        for one in silent:
            one.close()
        assert isinstance(numbers, list)
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        assert program.text.count("too slowly") == 1
        assert program.text.count("std_msgs/String") == 1
        ends_well(program, tmp_path)
