"""ROS 1's own master, tools and nodes meet our node."""

import asyncio
import contextlib
import functools
import logging
import os
import shutil
import signal
import socket
import struct
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import pytest

from tests.support.programs.peer_programs import skip_if_crashed
from tests.support.programs.ports import free_port
from thbridge.recording.bag.reading.reader import messages
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.rosgraph.wire.tcpros import encode_header
from thbridge.rosgraph.wire.xmlrpc import MethodResponse

PYTHON = "/usr/bin/python3"
TOOLS = ("rosmaster", "rostopic", "rosnode", "rosservice", "rosparam")
pytestmark = pytest.mark.skipif(
    any(shutil.which(tool) is None for tool in TOOLS),
    reason=f"not installed: {', '.join(TOOLS)} (see scripts/install_peers.sh)",
)

needs_rosbag = pytest.mark.skipif(shutil.which("rosbag") is None, reason="not installed: rosbag")

PATIENCE = 120.0
STRING = ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n")
TRIGGER = (
    "std_srvs/Trigger",
    "937c9679a518e3a18d831e57125ea522",
    "std_srvs/TriggerRequest",
    "std_srvs/TriggerResponse",
)


def string(text: str) -> bytes:
    """A serialized std_msgs/String."""
    return struct.pack("<I", len(text)) + text.encode()


def triggered(message: str) -> bytes:
    """A serialized std_srvs/TriggerResponse."""
    return b"\x01" + string(message)


def with_patience(test: Callable[..., Awaitable[None]]) -> Callable[..., None]:
    """Run a test's coroutine, but not for ever."""

    @functools.wraps(test)
    def run(*args, **kwargs) -> None:
        async def patient() -> None:
            async with asyncio.timeout(2 * PATIENCE):
                await test(*args, **kwargs)

        asyncio.run(patient())

    return run


class Graph:
    """A master, and ROS's programs at it."""

    def __init__(self, port: int) -> None:
        self.uri = f"http://127.0.0.1:{port}"
        self._port = port
        self._master: asyncio.subprocess.Process | None = None

    async def start(self) -> None:
        self._master = await self.run("rosmaster", "--core", "-p", str(self._port))
        node = RosNode("/probe", self.uri)
        await eventually_async(lambda: _is_value(node.get_param("/")), "the master")

    async def kill(self) -> None:
        if self._master is not None:
            os.killpg(self._master.pid, signal.SIGKILL)
            await self._master.communicate()
            self._master = None

    async def run(self, *command: str) -> asyncio.subprocess.Process:
        kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
        return await asyncio.create_subprocess_exec(
            *command,
            env={**kept, "ROS_MASTER_URI": self.uri, "ROS_IP": "127.0.0.1", "PYTHONUNBUFFERED": "1"},
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            start_new_session=True,
        )

    async def says(self, *command: str) -> str:
        """All that a command has to say."""
        process = await self.run(*command)
        try:
            async with asyncio.timeout(PATIENCE):
                said, _ = await process.communicate()
        finally:
            await end(process)
        skip_if_crashed(command[0], process.returncode, said.decode())
        assert process.returncode == 0, said.decode()
        return said.decode()

    async def says_in_time(self, phrase: str, *command: str) -> str:
        """What a command that never ends says until a phrase is in it."""
        process = await self.run(*command)
        said = ""
        try:
            async with asyncio.timeout(PATIENCE):
                while phrase not in said:
                    data = await process.stdout.read(4096)
                    if not data:
                        skip_if_crashed(command[0], await process.wait(), said)
                    assert data, said
                    said += data.decode()
        finally:
            await end(process)
        return said


async def end(process: asyncio.subprocess.Process) -> None:
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
        try:
            async with asyncio.timeout(PATIENCE):
                await process.communicate()
        except TimeoutError:
            os.killpg(process.pid, signal.SIGKILL)
            await process.communicate()


async def eventually(true: Callable[[], object], what: str) -> None:
    async def checked() -> bool:
        return bool(true())

    await eventually_async(checked, what)


async def eventually_async(true: Callable[[], Awaitable[object]], what: str) -> None:
    try:
        async with asyncio.timeout(PATIENCE):
            while not await true():
                await asyncio.sleep(0.05)
    except TimeoutError:
        pytest.fail(f"waited in vain: {what}")


@asynccontextmanager
async def graph() -> AsyncIterator[Graph]:
    made = Graph(free_port())
    try:
        await made.start()
        yield made
    finally:
        await made.kill()


@asynccontextmanager
async def running(node: RosNode) -> AsyncIterator[RosNode]:
    assert isinstance(await node.start(), NodeStarted)
    try:
        await node.registered()
        yield node
    finally:
        await node.stop()


@asynccontextmanager
async def repeating(publication, data: bytes) -> AsyncIterator[None]:
    async def repeat() -> None:
        while True:
            publication.publish(data)
            await asyncio.sleep(0.02)

    task = asyncio.create_task(repeat())
    try:
        yield
    finally:
        task.cancel()


@pytest.mark.slow
@with_patience
async def test_rostopic_hears_us():
    async with graph() as ros:
        node = RosNode("/us", ros.uri)
        chatter = node.advertise("/chatter", *STRING)
        node.advertise("/latched", *STRING, latched=True).publish(string("from before"))
        async with running(node), repeating(chatter, string("hello")):
            assert "/chatter" in await ros.says("rostopic", "list")
            assert await ros.says("rostopic", "type", "/chatter") == "std_msgs/String\n"
            assert "* /us" in await ros.says("rostopic", "info", "/chatter")
            assert 'data: "hello"' in await ros.says("rostopic", "echo", "-n", "3", "/chatter")
            assert 'data: "from before"' in await ros.says("rostopic", "echo", "-n", "1", "/latched")
            assert "std dev" in await ros.says_in_time("window", "rostopic", "hz", "/chatter")
            assert "mean: 9.00B" in await ros.says_in_time("window", "rostopic", "bw", "/chatter")
        await eventually(lambda: chatter.subscribers == 0, "all of them gone")
        assert "/chatter" not in await ros.says("rostopic", "list")
        assert "/us" not in await ros.says("rosnode", "list")


@with_patience
async def test_we_hear_rostopic():
    async with graph() as ros:
        node, heard = RosNode("/us", ros.uri), []
        node.subscribe("/in", *STRING[:2], lambda data, caller: heard.append((data, caller)))
        async with running(node):
            first = await ros.run("rostopic", "pub", "-r", "20", "/in", "std_msgs/String", "hi")
            await eventually(lambda: heard, "the message")
            assert heard[0][0] == string("hi")
            assert heard[0][1].startswith("/rostopic_")
            await end(first)
            await ros.says("rostopic", "pub", "-1", "/in", "std_msgs/String", "again")
            await eventually(lambda: heard[-1][0] == string("again"), "the other message")
            assert [data for data, _ in heard].count(string("again")) == 1


@with_patience
async def test_rostopic_hears_us_beside_a_subscriber_that_never_reads():
    async with graph() as ros:
        node = RosNode("/us", ros.uri)
        chatter = node.advertise("/chatter", *STRING)
        started = await node.start()
        assert isinstance(started, NodeStarted)
        stalled = socket.socket()
        try:
            client = XmlRpcClient()
            offered = await client.call(started.uri, "requestTopic", "/stalled", "/chatter", [["TCPROS"]])
            await client.close()
            assert isinstance(offered, MethodResponse)
            stalled.connect(tuple(offered.value[2][1:]))
            stalled.sendall(encode_header({"callerid": "/stalled", "md5sum": "*", "topic": "/chatter"}))
            await eventually(lambda: chatter.subscribers == 1, "the stalled subscriber")
            while chatter.dropped == 0:
                chatter.publish(string("x" * 100_000))
            async with repeating(chatter, string("hello")):
                assert 'data: "hello"' in await ros.says("rostopic", "echo", "-n", "10", "/chatter")
        finally:
            stalled.close()
            await node.stop()


@with_patience
async def test_rosnode_knows_us():
    async with graph() as ros:
        node, heard = RosNode("/us", ros.uri), []
        node.advertise("/chatter", *STRING, latched=True).publish(string("hello"))
        node.subscribe("/chatter", *STRING[:2], lambda data, caller: heard.append((data, caller)))
        async with running(node):
            await eventually(lambda: heard, "our own message")
            assert heard == [(string("hello"), "/us")]
            assert "xmlrpc reply from" in await ros.says("rosnode", "ping", "-c", "1", "/us")
            info = await ros.says("rosnode", "info", "/us")
            assert f"Pid: {os.getpid()}" in info
            assert "direction: outbound (" in info
            assert "direction: inbound (" in info
            assert "transport: TCPROS" in info


@needs_rosbag
@with_patience
async def test_the_cpp_nodes_of_rosbag_hear_us_and_are_heard(tmp_path):
    bag = tmp_path / "chatter.bag"
    async with graph() as ros:
        node, heard = RosNode("/us", ros.uri), []
        chatter = node.advertise("/chatter", *STRING)
        node.advertise("/latched", *STRING, latched=True).publish(string("from before"))
        node.subscribe("/repeated", *STRING[:2], lambda data, caller: heard.append(data))
        async with running(node):
            topics = ("/chatter", "/latched")
            recorder = await ros.run("rosbag", "record", *topics, "--limit=100", "-O", str(bag), "__name:=recorder")
            await eventually(lambda: chatter.subscribers == 1, "the recorder")
            await eventually_async(
                lambda: received(ros, "/recorder", "/latched", 1), "the recorder to have the latched"
            )
            for number in range(100):
                chatter.publish(string(f"message {number}"))
            # It goes when it has taken as many as it may.
            await eventually(lambda: chatter.subscribers == 0, "the recorder to have them all")
            await end(recorder)
            recorded = list(messages(bag))
            said = [message.data for message in recorded if message.topic == "/chatter"]
            assert said == [string(f"message {number}") for number in range(100)]
            assert [message.data for message in recorded if message.topic == "/latched"] == [string("from before")]
            chosen = ("--topics", "/chatter", "--bags", str(bag), "/chatter:=/repeated")
            player = await ros.run("rosbag", "play", "-q", "--keep-alive", "--wait-for-subscribers", *chosen)
            await eventually(lambda: len(heard) >= 100, "the player's messages")
            await end(player)
            assert heard == said


@with_patience
async def test_rosservice_calls_us():
    async def in_time(request: bytes) -> bytes:
        await asyncio.sleep(0.01)
        return triggered("later")

    async with graph() as ros:
        node = RosNode("/us", ros.uri)
        node.serve("/now", *TRIGGER, lambda request: triggered("at once"))
        node.serve("/later", *TRIGGER, in_time)
        node.serve("/never", *TRIGGER, lambda request: ServiceFailed("the door is shut"))
        async with running(node):
            assert await ros.says("rosservice", "type", "/now") == "std_srvs/Trigger\n"
            assert "rosrpc://127.0.0.1:" in await ros.says("rosservice", "info", "/now")
            assert await ros.says("rosservice", "args", "/now") == "\n"
            assert 'message: "at once"' in await ros.says("rosservice", "call", "/now")
            assert 'message: "later"' in await ros.says("rosservice", "call", "/later")
            assert "the door is shut" in await ros.says_in_time("shut", "rosservice", "call", "/never")
            persistent = """
import rospy, std_srvs.srv
call = rospy.ServiceProxy("/now", std_srvs.srv.Trigger, persistent=True)
print([call().message for _ in range(3)])
"""
            assert "['at once', 'at once', 'at once']" in await ros.says(PYTHON, "-c", persistent)


async def received(ros: Graph, node: str, topic: str, count: int) -> bool:
    """Whether a C++ node has so many messages of a topic; it answers without ROS's code and message."""
    client = XmlRpcClient()
    found = await client.call(ros.uri, "lookupNode", "/probe", node)
    assert isinstance(found, MethodResponse)
    stats = await client.call(found.value[2], "getBusStats", "/probe")
    await client.close()
    assert isinstance(stats, MethodResponse)
    _, subscribed = stats.value
    # A topic is listed before its first connection is.
    return [messages for name, links in subscribed if name == topic for [_, _, messages, *_] in links] == [count]


async def _is_value(answer: Awaitable[object]) -> bool:
    return not isinstance(await answer, CallFailed)


@with_patience
async def test_rosparam_and_we_see_the_same_parameters():
    async with graph() as ros:
        node, changes = RosNode("/us", ros.uri), []
        node.subscribe_param("/robot1/amcl", lambda key, value: changes.append((key, value)))
        node.declare_param("/robot1/amcl", {"odom_alpha1": 0.2})
        async with running(node):
            assert await ros.says("rosparam", "get", "/robot1/amcl/odom_alpha1") == "0.2\n"
            await ros.says("rosparam", "set", "/robot1/amcl/odom_alpha1", "0.3")
            assert await node.get_param("/robot1/amcl") == {"odom_alpha1": 0.3}
            await eventually(lambda: changes, "the change")
            assert changes == [("/robot1/amcl/odom_alpha1", 0.3)]
            assert isinstance(await node.get_param("/nothing"), CallFailed)


@pytest.mark.slow
@with_patience
async def test_a_master_that_comes_late_and_again_is_told_everything():
    log: list[str] = []
    ros = Graph(free_port())
    node = RosNode("/us", ros.uri, on_lost=lambda: log.append("lost"), on_found=lambda: log.append("found"))
    heard: list[bytes] = []
    node.advertise("/chatter", *STRING, latched=True).publish(string("hello"))
    node.subscribe("/in", *STRING[:2], lambda data, caller: heard.append(data))
    node.serve("/now", *TRIGGER, lambda request: triggered("at once"))
    assert isinstance(await node.start(), NodeStarted)
    try:
        for _ in range(2):
            log.clear()
            await ros.start()
            await eventually(lambda: log == ["found"], "the registration")
            assert 'data: "hello"' in await ros.says("rostopic", "echo", "-n", "1", "/chatter")
            assert 'message: "at once"' in await ros.says("rosservice", "call", "/now")
            heard.clear()
            publisher = await ros.run("rostopic", "pub", "-r", "20", "/in", "std_msgs/String", "hi")
            await eventually(lambda: heard, "the message")
            await end(publisher)
            log.clear()
            await ros.kill()
            await eventually(lambda: log == ["lost"], "the loss to be noticed")
    finally:
        await node.stop()
        await ros.kill()


@with_patience
async def test_a_node_of_the_same_name_replaces_us():
    usurper = """
import rospy, std_msgs.msg
rospy.init_node("us")
rospy.Publisher("/chatter", std_msgs.msg.String, latch=True, queue_size=1).publish("theirs")
rospy.spin()
"""
    async with graph() as ros:
        reasons: list[str] = []
        node = RosNode("/us", ros.uri, on_shutdown=reasons.append)
        node.advertise("/chatter", *STRING)
        async with running(node):
            process = await ros.run(PYTHON, "-c", usurper)
            try:
                await eventually(lambda: reasons, "the word to go")
                await node.stop()
                assert 'data: "theirs"' in await ros.says("rostopic", "echo", "-n", "1", "/chatter")
                assert len(reasons) == 1
            finally:
                await end(process)


@with_patience
async def test_rosnode_kill_tells_us_to_go():
    async with graph() as ros:
        reasons: list[str] = []
        node = RosNode("/us", ros.uri, on_shutdown=reasons.append)
        node.advertise("/chatter", *STRING)
        async with running(node):
            await ros.says("rosnode", "kill", "/us")
            await eventually(lambda: reasons, "the word to go")


@with_patience
async def test_a_subscriber_of_another_type_is_refused_and_complained_of_once(caplog):
    mistaken = """
import rospy, std_msgs.msg
rospy.init_node("mistaken")
rospy.Subscriber("/chatter", std_msgs.msg.Int32, print)
rospy.spin()
"""
    async with graph() as ros:
        node = RosNode("/us", ros.uri)
        chatter = node.advertise("/chatter", *STRING)
        with caplog.at_level(logging.WARNING):
            async with running(node), repeating(chatter, string("hello")):
                process = await ros.run(PYTHON, "-c", mistaken)
                try:
                    await eventually(lambda: "std_msgs/Int32" in caplog.text, "the complaint")
                    assert 'data: "hello"' in await ros.says("rostopic", "echo", "-n", "1", "/chatter")
                finally:
                    await end(process)
        assert caplog.text.count("std_msgs/Int32") == 1
