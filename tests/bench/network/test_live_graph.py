"""A whole hunt of ten robots at the pace of the clock, on graphs: what listeners cost, and how even ticks are.

Three nodes of another process hear every topic. The stalled one is a fourth that subscribes to every topic and never
reads; so that it stalls at once, sockets hold little of what is sent.
"""

import asyncio
import dataclasses
import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import TICK
from tests.bench.budget import Budgets
from tests.support.programs.ports import free_domain, free_port
from thbridge.app import listeners, play
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.recording import build_publisher
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions
from thbridge.roles.participant.tabui import TabUI
from thbridge.ros.topics import CLOCK
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.topics import SessionTopics
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.rosgraph.sockets import tcpros_server
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

ROBOTS = 10
WARM_UP = 8.0
SECONDS = 25.0  # the hunt takes 37
LISTENERS = 3
SEND_BUFFER = 16384
DOMAIN = free_domain()

LISTEN = """
import asyncio, json, sys, time
from thbridge.rosgraph.sockets.node import RosNode

async def main():
    master, number, first, last = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
    topics = json.loads(sys.stdin.readline())
    heard, clock, now = 0, [], 0.0
    over = asyncio.Event()

    def tick(data, caller):
        nonlocal now
        now = int.from_bytes(data[:4], "little") + int.from_bytes(data[4:], "little") * 1e-9 - 1.0
        if first <= now < last:
            clock.append(time.monotonic())
        elif now >= last:
            over.set()

    def hear(data, caller):
        nonlocal heard
        heard += first <= now < last

    nodes = [RosNode(f"/listener{each}", master) for each in range(number)]
    for each, node in enumerate(nodes):
        for topic in topics:
            node.subscribe(topic, "*", "*", hear)
        if each == 0:
            node.subscribe("/clock", "*", "*", tick)
        await node.start()
    await over.wait()
    print(json.dumps([heard, clock]), flush=True)
    for node in nodes:
        await node.stop()

asyncio.run(main())
"""

LISTEN_ROS2 = """
import asyncio, json, sys, time
from thbridge.ros2.qos import QosProfile, Durability, DeliveryReliability
from thbridge.ros2.supports import MessageSupport
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import NodeName

async def main():
    domain, number, first, last = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
    topics = json.loads(sys.stdin.readline())
    heard, clock, now = 0, [], 0.0
    over = asyncio.Event()

    def tick(data, gid):
        nonlocal now
        now = int.from_bytes(data[4:8], "little") + int.from_bytes(data[8:12], "little") * 1e-9 - 1.0
        if first <= now < last:
            clock.append(time.monotonic())
        elif now >= last:
            over.set()

    def hear(data, gid):
        nonlocal heard
        heard += first <= now < last

    carriers = [DdsCarrier(domain) for _ in range(number)]
    for each, carrier in enumerate(carriers):
        node = NodeName("/", f"listener{each}")
        for name, kind, hash_, depth, reliability, durability in topics:
            take = tick if name == "/clock" and each == 0 else hear
            qos = QosProfile(depth, DeliveryReliability(reliability), Durability(durability))
            carrier.subscribe(node, name, MessageSupport(kind, hash_), qos, take)
        await carrier.start()
    await over.wait()
    print(json.dumps([heard, clock]), flush=True)
    for carrier in carriers:
        await carrier.stop()

asyncio.run(main())
"""

STALL = """
import asyncio, json, socket, sys
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.wire.tcpros import encode_header

async def main():
    client, topics, sockets = XmlRpcClient(), json.loads(sys.stdin.readline()), []
    while True:
        found = await client.call(sys.argv[1], "lookupNode", "/stalled", "/thbridge")
        if not isinstance(found, CallFailed) and found.value[0] == 1:
            break
        await asyncio.sleep(0.2)
    await asyncio.sleep(1.0)
    for topic in topics:
        asked = await client.call(found.value[2], "requestTopic", "/stalled", topic, [["TCPROS"]])
        one = socket.socket()
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        one.connect(tuple(asked.value[2][1:]))
        one.sendall(encode_header({"callerid": "/stalled", "md5sum": "*", "type": "*", "topic": topic}))
        sockets.append(one)
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)

asyncio.run(main())
"""


@dataclasses.dataclass
class Measured:
    """Of the window: when each tick ended, the processor time of all then, and what became of the messages."""

    walls: np.ndarray
    cpus: np.ndarray
    dropped: int = 0
    heard: int = 0
    clock: np.ndarray | None = None

    def told(self, name: str) -> str:
        periods, cpus = 1e3 * np.diff(self.walls), 1e3 * np.diff(self.cpus)
        share = 100 * (self.cpus[-1] - self.cpus[0]) / (self.walls[-1] - self.walls[0])
        text = (
            f"\n{name}: {share:.1f} % of a core; period of ticks {periods.mean():.2f} ms, std {periods.std():.2f}, "
            f"99 % within {np.percentile(periods, 99):.1f}, longest {periods.max():.1f}; "
            f"CPU per tick {cpus.mean():.2f} ms, 99 % within {np.percentile(cpus, 99):.2f}, most {cpus.max():.2f}"
        )
        if self.clock is not None:
            clock = 1e3 * np.diff(self.clock)
            text += (
                f"; heard {self.heard / SECONDS:.0f} messages/s by {LISTENERS} together, {self.dropped} dropped; "
                f"/clock at a listener: std {clock.std():.2f} ms, longest {clock.max():.1f}"
            )
        return text

    def judge(self, name: str, budgets: Budgets) -> None:
        """Ticks come every 20 ms, here and at a listener, and take no longer than they did."""
        for clock in (self.walls, self.clock):
            assert clock is None or np.median(np.diff(clock)) == pytest.approx(TICK, abs=0.1 * TICK)
        budgets.time(f"live graph: a tick, {name}", float(np.diff(self.cpus).mean()))


def hunt(monkeypatch: pytest.MonkeyPatch, graph: GraphAddress | None, ros2: Ros2Address | None = None) -> Measured:
    study = dataclasses.replace(Study(), robots=ROBOTS, map="warehouse12", seed=1)
    study = dataclasses.replace(study, server=dataclasses.replace(study.server, port=0))
    setting = read_setting(study, Path())
    participant = TabUI(build_bot(setting.templates, setting.study.participant.strategy, study.seed))
    made, walls, cpus = [], [], []

    class Kept(listeners.LiveGraph):
        def __init__(self, *arguments) -> None:
            super().__init__(*arguments)
            made.append(self)

    monkeypatch.setattr(listeners, "LiveGraph", Kept)

    def progress(moment) -> None:
        if moment.tick >= WARM_UP * 50:
            walls.append(time.perf_counter())
            cpus.append(time.process_time())

    options = PlayOptions(1.0, None, frozenset(), "suggestion", WARM_UP + SECONDS + 1.0, graph, ros2=ros2)
    with pytest.raises(HuntUnfinished):
        asyncio.run(play.play(setting, (participant,), options, lambda where: None, progress))
    return Measured(np.array(walls), np.array(cpus), made[0].dropped if made else 0)


def beside(monkeypatch: pytest.MonkeyPatch, stalled: bool) -> Measured:
    port = free_port()
    graph = GraphAddress(f"http://127.0.0.1:{port}")
    study = dataclasses.replace(Study(), robots=ROBOTS, map="warehouse12")
    topics = [topic.name for topic in build_publisher(read_setting(study, Path())).topics]
    listening = (LISTEN, graph.master_uri, str(LISTENERS), str(WARM_UP), str(WARM_UP + SECONDS))
    scripts = [listening, *([(STALL, graph.master_uri)] if stalled else [])]
    running = [
        subprocess.Popen([sys.executable, "-c", *script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for script in scripts
    ]
    try:
        for process, what in zip(running, (topics, [*topics, CLOCK.name]), strict=False):
            process.stdin.write(json.dumps(what) + "\n")
            process.stdin.flush()
        measured = hunt(monkeypatch, graph)
        heard, clock = json.loads(running[0].communicate(timeout=30)[0])
        return dataclasses.replace(measured, heard=heard, clock=np.array(clock))
    finally:
        for process in running:
            process.kill()
            process.communicate()


def beside_ros2(monkeypatch: pytest.MonkeyPatch) -> Measured:
    address = Ros2Address(domain=DOMAIN)
    study = dataclasses.replace(Study(), robots=ROBOTS, map="warehouse12")
    types = Distribution.of(address.distribution.value)
    topics = SessionTopics(types, build_publisher(read_setting(study, Path())).topics, ROBOTS).all
    wanted = [
        (each.name, each.type, types.message(each.type).hash, each.qos.depth, each.qos.reliability, each.qos.durability)
        for each in topics
    ]
    script = (LISTEN_ROS2, str(DOMAIN), str(LISTENERS), str(WARM_UP), str(WARM_UP + SECONDS))
    process = subprocess.Popen(
        [sys.executable, "-c", *script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        process.stdin.write(json.dumps(wanted) + "\n")
        process.stdin.flush()
        measured = hunt(monkeypatch, None, address)
        heard, clock = json.loads(process.communicate(timeout=30)[0])
        return dataclasses.replace(measured, heard=heard, clock=np.array(clock))
    finally:
        process.kill()
        process.communicate()


def test_ten_robots_under_way_on_a_graph_of_ros2(budgets: Budgets, monkeypatch, capsys):
    alone = hunt(monkeypatch, None)
    unheard = hunt(monkeypatch, None, Ros2Address(domain=DOMAIN))
    heard = beside_ros2(monkeypatch)
    with capsys.disabled():
        print(f"\nload of the machine: {os.getloadavg()[0]:.1f}")
        print(alone.told("alone"), unheard.told("on ROS 2, unheard"), heard.told("on ROS 2"))
    heard.judge("three listeners on ROS 2", budgets)


def test_ten_robots_under_way_on_a_graph(budgets: Budgets, monkeypatch, capsys):
    alone = hunt(monkeypatch, None)
    heard = beside(monkeypatch, stalled=False)
    keep_alive = tcpros_server.keep_alive

    def with_little_room(transport: asyncio.Transport) -> None:
        keep_alive(transport)
        transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)

    monkeypatch.setattr(tcpros_server, "keep_alive", with_little_room)
    stalled = beside(monkeypatch, stalled=True)
    with capsys.disabled():
        print(f"\nload of the machine: {os.getloadavg()[0]:.1f}")
        print(alone.told("alone"), heard.told("on a graph"), stalled.told("one of four stalled"))
    for name, measured in (("alone", alone), ("three listeners", heard), ("and a stalled one", stalled)):
        measured.judge(name, budgets)
    assert heard.dropped == 0
    assert stalled.dropped > 0
