"""The live graph of ten robots: what publishing costs, beside rospy, and what a stalled subscriber does to it.

The subscribers are three of our nodes in one other process; rospy publishes the same to the same.
"""

import asyncio
import os
import shutil
import socket
import struct
import subprocess
import sys
import time

import pytest

from tests.bench.budget import Budgets
from thbridge.rosgraph.sockets.http_client import XmlRpcClient
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.sockets.publications import Publication
from thbridge.rosgraph.wire.tcpros import encode_header

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(shutil.which("rosmaster") is None, reason="Debian's python3-rosmaster is not installed"),
]

ROBOTS = 10
SECONDS = 10.0
TICK = 0.02
TOPICS = {
    "odom": (720, 1),
    "base_pose_ground_truth": (720, 1),
    "scan": (2 * 4 * 360 + 60, 5),
    "cmd_vel": (48, 5),
}
"""By topic of a robot: bytes of a message, and every how many ticks there is one. 120 messages/s and robot."""

SUBSCRIBERS = 3
TYPE = ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1")

LISTENERS = """
import asyncio, sys
from thbridge.rosgraph.sockets.node import RosNode

async def main():
    master, topics, count = sys.argv[1], sys.argv[2].split(","), 0
    def heard(data, caller):
        nonlocal count
        count += 1
    nodes = [RosNode(f"/listener{number}", master) for number in range(int(sys.argv[3]))]
    for node in nodes:
        for topic in topics:
            node.subscribe(topic, "*", "*", heard)
        await node.start()
        await node.registered()
    print("ready", flush=True)
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)
    print(count, flush=True)
    for node in nodes:
        await node.stop()

asyncio.run(main())
"""

ROSPY = """
import sys, time, rospy
from std_msgs.msg import String
master, seconds, tick, listeners = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
rospy.init_node("bench", disable_signals=True)
work = []
for word in sys.argv[5:]:
    topic, size, every = word.split(",")
    work.append((rospy.Publisher(topic, String, queue_size=100), String("x" * (int(size) - 4)), int(every)))
while any(publisher.get_num_connections() < listeners for publisher, _, _ in work):
    time.sleep(0.05)
sent, cpu, began = 0, time.process_time(), time.monotonic()
for number in range(round(seconds / tick)):
    for publisher, message, every in work:
        if number % every == 0:
            publisher.publish(message)
            sent += 1
    time.sleep(max(0.0, began + (number + 1) * tick - time.monotonic()))
print(sent, time.monotonic() - began, time.process_time() - cpu, flush=True)
time.sleep(0.5)
"""


@pytest.fixture
def master():
    """URI of a rosmaster."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    process = subprocess.Popen(
        ["rosmaster", "--core", "-p", str(port)],
        env=_clean(f"http://127.0.0.1:{port}"),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    yield f"http://127.0.0.1:{port}"
    process.kill()
    process.wait()


def _clean(master: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    return {**kept, "ROS_MASTER_URI": master, "ROS_IP": "127.0.0.1"}


def _topics() -> dict[str, tuple[int, int]]:
    return {f"/robot{robot + 1}/{name}": shape for robot in range(ROBOTS) for name, shape in TOPICS.items()}


async def _listeners(master: str) -> asyncio.subprocess.Process:
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        *("-c", LISTENERS, master, ",".join(_topics()), str(SUBSCRIBERS)),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
    )
    assert await process.stdout.readline() == b"ready\n"
    return process


async def _heard(process: asyncio.subprocess.Process) -> int:
    out, _ = await process.communicate(b"\n")
    return int(out)


async def _ours(node: RosNode) -> dict[Publication, tuple[bytes, int]]:
    work = {
        node.advertise(topic, *TYPE, "string data\n"): (struct.pack("<I", size - 4) + b"x" * (size - 4), every)
        for topic, (size, every) in _topics().items()
    }
    assert isinstance(await node.start(), NodeStarted)
    async with asyncio.timeout(60):
        while any(publication.subscribers < SUBSCRIBERS for publication in work):
            await asyncio.sleep(0.01)
    return work


def test_ten_robots(master, budgets: Budgets, capsys):
    async def ours() -> tuple[int, float, float, int, int]:
        process = await _listeners(master)
        node = RosNode("/bench", master)
        work = await _ours(node)
        loop = asyncio.get_running_loop()
        sent, cpu, began = 0, time.process_time(), loop.time()
        for number in range(round(SECONDS / TICK)):
            for publication, (message, every) in work.items():
                if number % every == 0:
                    publication.publish(message)
                    sent += 1
            await asyncio.sleep(began + (number + 1) * TICK - loop.time())
        wall, cpu = loop.time() - began, time.process_time() - cpu
        await asyncio.sleep(0.5)
        heard = await _heard(process)
        await node.stop()
        return sent, wall, cpu, heard, sum(publication.dropped for publication in work)

    async def rospys() -> tuple[int, float, float, int]:
        process = await _listeners(master)
        shapes = [f"{topic},{size},{every}" for topic, (size, every) in _topics().items()]
        arguments = (master, str(SECONDS), str(TICK), str(SUBSCRIBERS), *shapes)
        publisher = await asyncio.create_subprocess_exec(
            *("/usr/bin/python3", "-c", ROSPY, *arguments), env=_clean(master), stdout=asyncio.subprocess.PIPE
        )
        out, _ = await publisher.communicate()
        sent, wall, cpu = out.split()
        return int(sent), float(wall), float(cpu), await _heard(process)

    sent, wall, cpu, heard, dropped = asyncio.run(ours())
    their_sent, their_wall, their_cpu, their_heard = asyncio.run(rospys())
    with capsys.disabled():
        print(
            f"\n{ROBOTS} robots to {SUBSCRIBERS} subscribers: {sent / wall:.0f} messages/s, each {SUBSCRIBERS} times; "
            f"{heard} of {SUBSCRIBERS * sent} heard, {dropped} dropped; {100 * cpu / wall:.1f} % of a core"
            f"\nrospy: {their_sent / their_wall:.0f} messages/s; {their_heard} of {SUBSCRIBERS * their_sent} heard; "
            f"{100 * their_cpu / their_wall:.1f} % of a core, {their_cpu / their_sent / (cpu / sent):.1f} times ours"
        )
    assert heard == SUBSCRIBERS * sent
    assert dropped == 0
    budgets.ratio(
        f"publishing: a message to {SUBSCRIBERS} subscribers, beside rospy", cpu / sent / (their_cpu / their_sent)
    )


def test_a_stalled_subscriber(master, budgets: Budgets, capsys):
    async def measured() -> tuple[list[float], list[float], int]:
        node = RosNode("/bench", master)
        scan = node.advertise("/scan", *TYPE, "string data\n")
        started = await node.start()
        assert isinstance(started, NodeStarted)
        client = XmlRpcClient()
        asked = await client.call(started.uri, "requestTopic", "/stalled", "/scan", [["TCPROS"]])
        await client.close()
        stalled = socket.create_connection(tuple(asked.value[2][1:]))
        stalled.sendall(encode_header({"callerid": "/stalled", "md5sum": "*", "topic": "/scan"}))
        while not scan.subscribers:
            await asyncio.sleep(0.01)
        walls, cpus, message = [], [], b"x" * 3000
        for _ in range(10_000):
            await asyncio.sleep(0)
            wall, cpu = time.perf_counter(), time.thread_time()
            scan.publish(message)
            cpus.append(time.thread_time() - cpu)
            walls.append(time.perf_counter() - wall)
        stalled.close()
        await node.stop()
        return walls, cpus, scan.dropped

    walls, cpus, dropped = asyncio.run(measured())
    with capsys.disabled():
        print(
            f"\npublish() to a subscriber that never reads, {len(walls)} messages of 3000 bytes, {dropped} dropped: "
            f"at most {1e3 * max(cpus):.2f} ms of CPU, {1e3 * max(walls):.2f} ms by the clock; "
            f"on average {1e6 * sum(walls) / len(walls):.1f} us"
        )
    assert dropped > 0
    assert max(cpus) < TICK / 2
    budgets.time("publishing: 1000 messages to a subscriber that never reads", 1e3 * sum(cpus) / len(cpus))
