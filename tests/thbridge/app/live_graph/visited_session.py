"""A session's doors to a ROS graph without the graph: a node that only remembers what it is to do."""

import asyncio
import inspect
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from sim.snapshot import TeamSnapshot
from tests.support.ros.packed_messages import STORE, header, packed, pose
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_team_description, build_writer
from thbridge.app.compose.robots import build_simr, build_team
from thbridge.app.compose.setting import StudySetting
from thbridge.app.compose.vehicles import vehicle_factory
from thbridge.app.live_graph import live
from thbridge.app.live_graph.client_messages import ClientRequests
from thbridge.app.live_graph.live import LiveGraph
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.inputs import ClientRequest
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import Session, TickRecord
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros.names import GRAPH_LINK
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue
from thbridge.text_protocol.wire import legacy

Answer = bytes | ServiceFailed


class Silence:
    """A publication that nobody subscribes to.

    Attributes:
        last: the last message.
    """

    dropped = 0

    def __init__(self) -> None:
        self.last = b""

    def publish(self, data: bytes) -> None:
        """Nobody hears it."""
        self.last = data


class Doors:
    """Stands in for `RosNode`."""

    def __init__(self, *_: object, **__: object) -> None:
        self.heard: dict[str, Callable[[bytes, str], None]] = {}
        self.services: dict[str, Callable[[bytes], Answer | Awaitable[Answer]]] = {}
        self.parameters: dict[str, Callable[[str, XmlRpcValue], None]] = {}
        self.declared: dict[str, XmlRpcValue] = {}
        self.advertised: dict[str, Silence] = {}

    def advertise(self, topic: str, *_: object, **__: object) -> Silence:
        self.advertised[topic] = Silence()
        return self.advertised[topic]

    def subscribe(self, topic: str, kind: str, md5: str, heard: Callable[[bytes, str], None]) -> None:
        self.heard[topic] = heard

    def serve(self, service: str, kind: str, md5: str, request: str, response: str, handler: object) -> None:
        assert callable(handler)
        self.services[service] = handler

    def subscribe_param(self, key: str, changed: Callable[[str, XmlRpcValue], None]) -> None:
        self.parameters[key] = changed

    def declare_param(self, key: str, value: XmlRpcValue) -> None:
        self.declared[key] = value


class Visited:
    """A hunt that nobody plays, on a graph whose clients knock by hand."""

    def __init__(self, setting: StudySetting, bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        made: list[Doors] = []

        def doors(*_: object, **__: object) -> Doors:
            made.append(Doors())
            return made[0]

        monkeypatch.setattr(live, "RosNode", doors)
        team, publisher = build_team(setting), build_publisher(setting)
        simr = build_simr(setting, team)
        graph = LiveGraph(
            GraphAddress(), build_team_description(setting, publisher), team, ClientRequests(self.ask), self._hear
        )
        self.doors = made[0]
        self.writer = build_writer(setting, bag)
        record = build_record(setting, PLAY, [legacy.SIMR, legacy.HIDER], "")
        recorder = BagRecorder(Broadcast(publisher, record, setting.map.grid, [graph, self.writer]))
        roles, vehicles = [simr, build_hider(setting.templates, setting.study.seed)], vehicle_factory(setting, simr)
        self._session = Session(build_keeper(setting), roles, [recorder], vehicles=vehicles)
        self._link = self._session.links.open_link(GRAPH_LINK) if setting.study.mavlink.on else LinkId(0)

    def ask(self, sender: str, request: Request) -> None:
        self._session.ask(sender, request)

    def _hear(self, robot: int, frame: Frame) -> None:
        self._session.transmit(self._session.links.receive_frame(self._link, frame, robot).replies)

    def say(self, topic: str, data: bytes, caller: str = "/client") -> None:
        self.doors.heard[topic](data, caller)

    def call(self, service: str, request: bytes = b"") -> Answer:
        async def answered() -> Answer:
            answer = self.doors.services[service](request)
            return await answer if inspect.isawaitable(answer) else answer

        return asyncio.run(answered())

    def set_parameter(self, key: str, value: XmlRpcValue) -> None:
        for below, changed in self.doors.parameters.items():
            if key.startswith(below):
                changed(key, value)

    def step(self) -> TickRecord:
        return self._session.step()

    def robots(self) -> TeamSnapshot:
        snapshot = self.step().snapshot
        assert snapshot is not None
        return snapshot


def asked(tick_record: TickRecord) -> list[Request]:
    return [item.request for item in tick_record.inputs if isinstance(item, ClientRequest)]


def goal_id(name: str, seconds: int = 0) -> object:
    return STORE.types["actionlib_msgs/msg/GoalID"](STORE.types["builtin_interfaces/msg/Time"](seconds, 0), name)


def goal(x: float, y: float, name: str = "", seconds: int = 0) -> bytes:
    target = STORE.types["geometry_msgs/msg/PoseStamped"](header(), pose(x, y, 0.0))
    wanted = STORE.types["move_base_msgs/msg/MoveBaseGoal"](target)
    kind = "move_base_msgs/msg/MoveBaseActionGoal"
    return packed(kind, header=header(), goal_id=goal_id(name, seconds), goal=wanted)


def cancel(name: str = "", seconds: int = 0) -> bytes:
    return bytes(STORE.serialize_ros1(goal_id(name, seconds), "actionlib_msgs/msg/GoalID"))
