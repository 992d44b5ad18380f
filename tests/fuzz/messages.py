"""Parsers of what comes through a door, or is a text within a record: bytes in, a value or a refusal out.

Whole examples come from a hunt that is kept for replays (`tests/system/studies_of_0_1/hunt.bag`), and from texts here.
"""

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass, field
from functools import cache
from itertools import islice
from types import SimpleNamespace
from typing import cast

import msgspec

from sim.parameters import RobotParameters, WorldParameters
from tests.support.bags.bags_with_faults import clean, content
from tests.support.hunts.watch_requests import GRANTED
from tests.support.mavlink.hostile_frames import orders
from tests.support.mavlink.vehicle_with_stations import VehicleWithStations
from tests.support.project import ROOT
from thbridge.app.session.input_records import from_record
from thbridge.app.session.watch_requests import WatchRequestHandler, request_line
from thbridge.credentials import KeyAnswer, key_line, parse_answer, secret_of
from thbridge.dialogue.portrait import DialoguePortrait, PortrayedBelief, PortrayedGame, read_portrait
from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.experiment.progress import BadHistory, Progress
from thbridge.experiment.store.decoding import BadEvent
from thbridge.experiment.store.decoding import decoded as event_of
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import LoggedEvent
from thbridge.hunt.codec import from_json
from thbridge.line_splitter import LineSplitter
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.values.vehicle_interface import Station
from thbridge.mavlink.wire.dialect import decoded, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser, parse_datagram
from thbridge.mavlink.wire.frames.signing import parse_key
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.recording.bag.reading.reader import recorded
from thbridge.roles.shared.robot_requests import Pause, Resume, SetRate, Step
from thbridge.roles.simr.team import RobotTeam
from thbridge.ros.messages import unpack
from thbridge.ros.messages.session_records import InputRecord
from thbridge.ros2.distribution import Distribution
from thbridge.rosgraph.wire.tcpros import FrameBuffer, decode_header
from thbridge.rosgraph.wire.xmlrpc import decode_call, decode_response
from thbridge.sockets.addresses import parse_address, parse_target
from thbridge.sockets.admission import parse_network
from thbridge.text_protocol.values.dialect import Dialect
from thbridge.text_protocol.wire import canonical, legacy
from thbridge.text_protocol.wire.lines import TextMessage, parse_line
from thbridge.text_protocol.wire.notice_format import Notice, NoticeValue, decode_notice, parse_notice
from thbridge.timing.pacer import Pacer
from thbridge.watching.wire import BagStreamReader, SessionMessage, WatcherRequest, WatcherSession, parse_status
from ui.model.watching.scene import PendingTurn, Wizard
from ui.model.watching.scene_builder import decode_wizard

HUNT = ROOT / "tests" / "system" / "studies_of_0_1" / "hunt.bag"


@dataclass(frozen=True)
class MessageTarget:
    """A parser of bytes.

    Attributes:
        quick: number of cases in the default tests.
        seeds: returns whole examples to make mistakes in.
        read: reads bytes; what raises is a fault, but for the errors of `refuses`.
        refuses: errors by which it says that the bytes are none of its own.
    """

    quick: int
    seeds: Callable[[], tuple[bytes, ...]]
    read: Callable[[bytes], object]
    refuses: tuple[type[Exception], ...] = field(default=())


@cache
def _hunt() -> dict[str, list[bytes]]:
    """The first messages of each type."""
    found: dict[str, list[bytes]] = {}
    for publisher, _, data in recorded(HUNT):
        kept = found.setdefault(publisher.msgtype, [])
        if len(kept) < 4:
            kept.append(bytes(data))
    return found


# The text server's lines

LINES = (
    b"%%setid SimR extended\n%%getid\n%%ping\n",
    b"%%goto TabUI SimR 0 3 3 45\n%%goto Game SimR 0 4\n",
    b'%%found Hider TabUI 1 1 "(Colour: Pink) (Footprint: Square and Small)"\n',
    b"%%pose SimR TabUI 0 1.5 -2.25 90\n%%snap TabUI SimR 0\n%%image SimR TabUI 0 rsz_t4.jpg\n",
    b"%%hide Hider SimR 1 3 2 pink can\n%%score TabUI Hider 12\n%%where TabUI SimR 0\n%%move SimR TabUI 1\n",
    b"%%send SimR TabUI %%error Game TabUI words with blanks\n%%ack\n%%sshhuuttddoowwnn\n",
)
_JSON = '{"kind":"%s","game":1,"room":3,"robot":0,"pieces":2,"piece":0,"data":"YQ==","text":"\\u0020a","agreed":true}'


@cache
def _notice_values() -> tuple[type[NoticeValue], ...]:
    return tuple(sorted(NoticeValue.__subclasses__(), key=lambda value_class: value_class.__name__))


def _lines() -> tuple[bytes, ...]:
    kinds = [str(value_class.__struct_config__.tag) for value_class in _notice_values()]
    notices = [f"%%error Game TabUI thbridge {_JSON % kind}\n".encode() for kind in kinds]
    lot = {"kind": "Whereabouts", "tick": 5, "motions": [{"robot": 0, "pose": [1.0, 2.0, 3.0], "speed": [0.1, 0.2]}]}
    house = {"kind": "House", "map": "a", "resolution": 0.05, "origin": [0, 0, 0], "width": 3, "height": 2,
             "cells": "eJxjYGAAAAADAAE=", "rooms": [], "footprint": [[0, 1], [1, 0], [0, 0]]}  # fmt: skip
    texts = [
        f"%%error Game TabUI thbridge {json.dumps(each, separators=(',', ':'))}\n".encode() for each in (lot, house)
    ]
    return (*LINES, *notices, *texts)


def _read_lines(data: bytes) -> None:
    for line in LineSplitter().feed(data + b"\n"):
        message = parse_line(line) if isinstance(line, str) else None
        if not isinstance(message, TextMessage):
            continue
        for decode in (legacy.decode, canonical.decode):
            decode(message)
        for dialect in Dialect:
            canonical.decode_goto(message, dialect, 8)
        notice = parse_notice(message)
        if isinstance(notice, Notice):
            for value_class in _notice_values():
                decode_notice(notice, value_class)


# The watch server's


def _requests() -> tuple[bytes, ...]:
    asked = [*GRANTED, Pause(), Resume(), SetRate(2.0), Step(3)]
    lines = [request_line("window", request) for request in asked]
    return (b'{"key": "a secret of some length"}\n' + lines[0], *lines)


@cache
def _team() -> RobotTeam:
    # The parts of a team that are looked at before a request is granted.
    return cast(
        RobotTeam, SimpleNamespace(size=2, parameters=2 * (RobotParameters(),), worlds=2 * (WorldParameters(),))
    )


def _read_requests(data: bytes) -> None:
    door = WatchRequestHandler(lambda sender, request: None, _team(), Pacer(1.0), has_game=True)
    session = WatcherSession()
    for event in session.feed(data + b"\n"):
        if isinstance(event, WatcherRequest):
            door.ask("watcher 1", event.value)


STATUS = b'{"paused":false,"rate":1.0,"lag":0.0,"watchers":1,"dropped":0,"refused":null,"refusals":0}'


def _stream() -> tuple[bytes, ...]:
    return content(clean())[:30_000], STATUS


def _read_stream(data: bytes) -> None:
    BagStreamReader().feed(data)
    parse_status(SessionMessage("/watch/status", "std_msgs/String", 0, b"\0\0\0\0" + data))


KEY_LINES = (
    key_line("a secret of some length"),
    KeyAnswer(admitted="maria").line(),
    KeyAnswer(refused="it was revoked").line(),
)


def _read_key_line(data: bytes) -> None:
    secret_of(data)
    parse_answer(data)


# ROS's

CALLS = (
    b"<?xml version='1.0'?>\n<methodCall><methodName>registerSubscriber</methodName><params>"
    b"<param><value><string>/a</string></value></param><param><value>/tf</value></param>"
    b"<param><value><array><data><value><i4>1</i4></value><value><double>2.5</double></value>"
    b"<value><boolean>1</boolean></value><value><base64>YQ==</base64></value></data></array></value></param>"
    b"<param><value><struct><member><name>a</name><value><dateTime.iso8601>20200101T00:00:00</dateTime.iso8601>"
    b"</value></member></struct></value></param></params></methodCall>",
    b"<?xml version='1.0'?>\n<methodResponse><params><param><value><array><data><value><int>1</int></value>"
    b"<value>ready</value><value><array><data/></array></value></data></array></value></param></params></methodResponse>",
    b"<?xml version='1.0'?><methodResponse><fault><value><struct><member><name>faultCode</name><value><int>4</int>"
    b"</value></member><member><name>faultString</name><value>no</value></member></struct></value></fault></methodResponse>",
)


def _read_xmlrpc(data: bytes) -> None:
    decode_call(data)
    decode_response(data)


ROS2_TYPES = {
    "nav_msgs/msg/Odometry": "nav_msgs/Odometry",
    "nav_msgs/msg/Path": "nav_msgs/Path",
    "sensor_msgs/msg/LaserScan": "sensor_msgs/LaserScan",
    "tf2_msgs/msg/TFMessage": "tf2_msgs/TFMessage",
    "rcl_interfaces/srv/SetParameters_Request": None,
    "nav2_msgs/action/NavigateToPose_SendGoal_Request": None,
    "rmw_dds_common/msg/ParticipantEntitiesInfo": None,
}
"""Types of ROS 2 with their types of ROS 1; None if there is none."""


@cache
def _ros2_messages() -> tuple[bytes, ...]:
    kilted = Distribution.of("kilted")
    transform = kilted.make("geometry_msgs/msg/TransformStamped", child_frame_id="robot1/odom")
    parameter = kilted.make("rcl_interfaces/msg/Parameter", name="use_sim_time")
    filled: dict[str, dict[str, object]] = {
        "nav_msgs/msg/Path": {"poses": [kilted.make("geometry_msgs/msg/PoseStamped")] * 3},
        "sensor_msgs/msg/LaserScan": {"ranges": [1.0, 2.0]},
        "tf2_msgs/msg/TFMessage": {"transforms": [transform, transform]},
        "rcl_interfaces/srv/SetParameters_Request": {"parameters": [parameter]},
    }
    return tuple(
        f"{name}\n".encode() + kilted.encode(name, kilted.make(name, **filled.get(name, {}))) for name in ROS2_TYPES
    )


def _read_ros2_message(data: bytes) -> None:
    """Read a message of the type in the first line; other names stand for the first type."""
    kilted = Distribution.of("kilted")
    line, _, message = data.partition(b"\n")
    name = next((known for known in ROS2_TYPES if known.encode() == line), next(iter(ROS2_TYPES)))
    with suppress(ValueError):
        kilted.decode(name, message)
    ros1_type = ROS2_TYPES[name]
    if ros1_type is not None:
        _ros1_converter(name, ros1_type)(message)


@cache
def _ros1_converter(name: str, ros1_type: str) -> Callable[[bytes], bytes]:
    return Distribution.of("kilted").to_ros1(name, ros1_type)


def _headers() -> tuple[bytes, ...]:
    fields = (
        b"callerid=/a",
        b"topic=/tf",
        b"type=tf2_msgs/TFMessage",
        b"md5sum=*",
        b"latching=1",
        b"message_definition=a b",
    )
    body = b"".join(len(each).to_bytes(4, "little") + each for each in fields)
    return body, len(body).to_bytes(4, "little") + body


def _read_header(data: bytes) -> None:
    decode_header(data)
    buffer = FrameBuffer()
    buffer.feed(data)
    while isinstance(body := buffer.take(1 << 20), bytes):
        decode_header(body)


UNPACKED: dict[str, Callable[[bytes], object]] = {
    "actionlib_msgs/GoalStatusArray": unpack.goal_status_array,
    "move_base_msgs/MoveBaseActionGoal": unpack.move_base_goal,
    "move_base_msgs/MoveBaseActionFeedback": unpack.move_base_feedback,
    "nav_msgs/Odometry": unpack.odometry,
    "nav_msgs/OccupancyGrid": unpack.occupancy_grid,
    "nav_msgs/Path": unpack.path,
    "geometry_msgs/PoseWithCovarianceStamped": unpack.pose_with_covariance,
    "geometry_msgs/PoseStamped": unpack.pose_stamped,
    "geometry_msgs/PolygonStamped": unpack.polygon,
    "geometry_msgs/PoseArray": unpack.pose_array,
    "geometry_msgs/Twist": unpack.twist,
    "sensor_msgs/LaserScan": unpack.laser_scan,
    "sensor_msgs/BatteryState": unpack.battery_state,
    "tf2_msgs/TFMessage": unpack.spatial_transforms,
    "visualization_msgs/MarkerArray": unpack.room_labels,
    "diagnostic_msgs/DiagnosticArray": unpack.diagnostic_array,
    "rosgraph_msgs/Log": unpack.log,
    "std_msgs/String": unpack.string,
    "thbridge_msgs/Session": unpack.session,
    "thbridge_msgs/GameEvent": unpack.game_event,
    "thbridge_msgs/Utterance": unpack.utterance,
    "thbridge_msgs/Score": unpack.score,
    "thbridge_msgs/Input": unpack.outside_input,
}


def _ros_messages() -> tuple[bytes, ...]:
    # The number of the type stands before the message.
    found = ((number, data) for number, kind in enumerate(UNPACKED) for data in islice(_hunt().get(kind, ()), 2))
    return tuple(bytes([number]) + data for number, data in found if len(data) < 30_000)


def _unpack_message(data: bytes) -> None:
    functions = (*UNPACKED.values(), unpack.transforms, unpack.transform_pieces, unpack.mavlink, unpack.outlines)
    functions[(data[0] if data else 0) % len(functions)](data[1:])


# MAVLink's

_RIGS: list[VehicleWithStations] = []


def _frames() -> tuple[bytes, ...]:
    told = [(message.get_msgId(), payload_of(message)) for message in orders(3)]
    return tuple(message_id.to_bytes(3, "little") + payload for message_id, payload in told)


def _hear_frame(data: bytes) -> None:
    """A vehicle hears the message; frames with wrong checksums end before, which the target "tlog" has."""
    parse_datagram(data)
    message = decoded(int.from_bytes(data[:3], "little"), data[3:])
    if message is None:
        return
    if not _RIGS or _RIGS[0].tick > 5000:
        _RIGS[:] = [VehicleWithStations(identity=identity) for identity in AutopilotIdentity]
    for rig in _RIGS:
        for _ in rig.vehicle.handle_message(LinkId(0), Station(255, 190), message):
            pass
        rig.run(1)


def _datagrams() -> tuple[bytes, ...]:
    return tuple(Frame(255, 190, number, 0, bytes(range(9)), 50).to_bytes() * 2 for number in range(3))


def _read_datagram(data: bytes) -> None:
    parse_datagram(data)
    parser = FrameParser()
    for at in range(0, len(data), 7):
        parser.receive_data(data[at : at + 7])
    parser.end()


# Texts within records


def _input_records() -> tuple[bytes, ...]:
    records = [unpack.outside_input(data) for data in _hunt()["thbridge_msgs/Input"]]
    return tuple(f"{record.kind}\n{record.json}".encode() for record in records)


def _read_input(data: bytes) -> None:
    kind, _, text = data.decode(errors="replace").partition("\n")
    from_record(InputRecord(kind, "somebody", "", text))


def _events() -> tuple[bytes, ...]:
    lines = (ROOT / "tests" / "thbridge" / "hunt" / "recorded_events.jsonl").read_bytes().splitlines()
    return tuple(lines)


PORTRAIT = DialoguePortrait(
    (PortrayedGame(1, 0, "persuasion", "a", "robot", ""),),
    (PortrayedBelief("a", "robot", 1.0, 0.5),),
    ("a <- b",),
    ("a",),
)
WIZARD = msgspec.json.encode(Wizard((0, 1), (PendingTurn(0, 0, 0, "say", 4, ("Are you sure?",)),)))


def _read_portrait(data: bytes) -> None:
    read_portrait(data.decode(errors="replace"))


def _read_event(data: bytes) -> None:
    from_json(data.decode(errors="replace"))


PEOPLE = ROOT / "tests" / "system" / "studies_of_0_1" / "with-people"


@cache
def _study_events() -> tuple[bytes, ...]:
    """The contents of a log, one of each kind, whose digests would keep mistakes from what reads them."""
    with closing(sqlite3.connect(f"file:{PEOPLE}/store/log?mode=ro&immutable=1", uri=True)) as database:
        rows = database.execute("SELECT content FROM events ORDER BY sequence").fetchall()
    kinds = {json.loads(content)["kind"]: content.encode() for (content,) in reversed(rows)}
    return tuple(kinds.values())


@cache
def _people() -> Progress:
    """People who have just begun."""
    entries = [entry for entry in read_log(PEOPLE / "store" / "log") if isinstance(entry, LoggedEvent)]
    return Progress(read_experiment(PEOPLE / "experiment.yaml")).after(entries[:3])


def _read_study_event(data: bytes) -> None:
    event = event_of(data.decode(errors="replace"))
    with suppress(BadHistory):  # most events cannot follow the first three
        _people().after([LoggedEvent(4, event)])


ADDRESSES = (b"10.0.0.1:14550", b"[::1]:5760", b"2@localhost:14550", b"10.0.0.0/24")


def _read_address(data: bytes) -> None:
    text = data.decode(errors="replace")
    parse_address(text)
    parse_target(text)
    parse_network(text)


MESSAGES = {
    "text-lines": MessageTarget(300, _lines, _read_lines),
    "watch-requests": MessageTarget(300, _requests, _read_requests),
    "watch-stream": MessageTarget(50, _stream, _read_stream),
    "xml-rpc": MessageTarget(300, lambda: CALLS, _read_xmlrpc),
    "tcpros": MessageTarget(300, _headers, _read_header),
    "ros-messages": MessageTarget(300, _ros_messages, _unpack_message, (ValueError,)),
    "ros2-messages": MessageTarget(300, _ros2_messages, _read_ros2_message, (ValueError,)),
    "mavlink": MessageTarget(150, _frames, _hear_frame),
    "datagrams": MessageTarget(300, _datagrams, _read_datagram),
    "inputs": MessageTarget(300, _input_records, _read_input, (ValueError,)),
    "events": MessageTarget(300, _events, _read_event, (ValueError,)),
    "study-events": MessageTarget(300, _study_events, _read_study_event, (BadEvent,)),
    "portraits": MessageTarget(200, lambda: (PORTRAIT.json().encode(),), _read_portrait, (ValueError,)),
    "wizard": MessageTarget(200, lambda: (len(WIZARD).to_bytes(4, "little") + WIZARD,), decode_wizard, (ValueError,)),
    "addresses": MessageTarget(300, lambda: ADDRESSES, _read_address),
    "key-line": MessageTarget(500, lambda: KEY_LINES, _read_key_line),
    "signing-key": MessageTarget(100, lambda: (b"a passphrase\n", b"0f" * 32, bytes(range(32))), parse_key),
}
