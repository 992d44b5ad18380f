"""What QGroundControl says when it meets a vehicle, and what it waits for: its state machine as its sources publish it.

Facts are from mavlink/qgroundcontrol, master of 2026: `InitialConnectStateMachine`, `RequestMessageCoordinator`,
`MavCommandQueue`, `StandardModes`, `RequestMetaDataTypeStateMachine`, `InitialParameterDownloader`, `FTPManager`,
`PlanManager`, `APMFirmwarePlugin`; and its releases 4 and 5 where they differ. Nothing is copied: this is a model to
judge vehicles by, and it notes for each request how often it had to ask.
"""

import json
import math
import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Protocol

from tests.peers.mavlink.qgroundcontrol_files import FileNotReadError, Files
from thbridge.mavlink.wire.dialect import Message, mav, name_of

SYSTEM, COMPONENT = 255, 190
AUTOPILOT = 1

COMMAND_TIMEOUT, COMMAND_TRIES = 3.0, 3
MESSAGE_TIMEOUT = 1.0
LIST_TIMEOUT, LIST_TRIES = 5.0, 5
PARAMETER_QUIET, PARAMETER_TRIES, PARAMETER_BATCH = 3.0, 5, 10
PLAN_TIMEOUT, ITEM_TIMEOUT, PLAN_RETRIES = 1.5, 0.25, 5
FTP_TIMEOUT, FTP_TRIES = 1.0, 4

COMPONENT_METADATA, COMPONENT_INFORMATION, PROTOCOL_VERSION, GIMBAL_MANAGER_INFORMATION = 397, 395, 300, 280
"""By number: pymavlink's dialect does not know all of them, and a vehicle need not either, as long as it says so."""

TYPE_PARAMETER = 1
"""Of COMP_METADATA_TYPE."""

FTP_NAK, FTP_OPEN = 129, 4
FTP_FILE_NOT_FOUND = 10
FTP_HEADER = struct.Struct("<HBBBBBxI")


class Link(Protocol):
    """The way to a vehicle, with its clock."""

    def send(self, message: Message) -> None:
        """Say something."""

    def receive(self, seconds: float) -> Message | None:
        """The next message of the vehicle; None if none comes so long."""

    def now(self) -> float:
        """Seconds."""


@dataclass(frozen=True, slots=True)
class Step:
    """One request and how it went.

    Attributes:
        name: what was asked for.
        asked: how often it had to be; more than once means that silence was the answer.
        answer: what came of it.
    """

    name: str
    asked: int
    answer: str


@dataclass(slots=True)
class Learned:
    """What the ground station knows after it has connected.

    Attributes:
        steps: its requests, in order.
        capabilities: bits of MAV_PROTOCOL_CAPABILITY.
        modes: custom mode and name of each that was offered.
        parameters: by name.
        items: of each mission type that was read.
        files: about the vehicle, by where they are.
        meanings: of parameters, as the file about them has them, by name.
    """

    steps: list[Step] = field(default_factory=list)
    capabilities: int = 0
    modes: dict[int, str] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)
    items: dict[int, list[Message]] = field(default_factory=dict)
    files: dict[str, bytes] = field(default_factory=dict)
    meanings: dict[str, dict[str, Any]] = field(default_factory=dict)


class QGroundControl:
    """One ground station and one vehicle.

    Args:
        link: to the vehicle.
        system: the vehicle's id.
        ardupilot: whether its heartbeat says so: more is asked of it then.
        modes_at_once: how the list of modes is asked for: by one request, or each by its own.
    """

    def __init__(self, link: Link, system: int, *, ardupilot: bool, modes_at_once: bool = False) -> None:
        self.link = link
        self.system = system
        self.ardupilot = ardupilot
        self.modes_at_once = modes_at_once
        self.learned = Learned()
        self.armed = self.flying = False
        self.mode = -1
        self.kept: list[Message] = []
        self.files = Files(self, system)

    def connect(self) -> Learned:
        """The whole sequence, from the first heartbeat to `initialConnectComplete`."""
        self.wait(60.0, "HEARTBEAT")
        if self.ardupilot:
            self.starts_streams()
        self.asks_for_version()
        self.asks_for_modes()
        self.asks_for_metadata()
        self.asks_for_gimbals()
        self.asks_for_parameters()
        self.tells_the_time()
        self.reads_plan(mav.MAV_MISSION_TYPE_MISSION)
        if self.learned.capabilities & mav.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE:
            self.reads_plan(mav.MAV_MISSION_TYPE_FENCE)
        if self.learned.capabilities & mav.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY:
            self.reads_plan(mav.MAV_MISSION_TYPE_RALLY)
        return self.learned

    # What is asked at first, in this order.

    def starts_streams(self) -> None:
        for stream in (1, 2, 3, 6, 10, 11, 12):
            self.link.send(mav.MAVLink_request_data_stream_message(self.system, AUTOPILOT, stream, 4, 1))
        for message in (mav.MAVLINK_MSG_ID_HOME_POSITION, mav.MAVLINK_MSG_ID_EXTENDED_SYS_STATE):
            self.command("stream", mav.MAV_CMD_SET_MESSAGE_INTERVAL, message, 1_000_000.0)

    def asks_for_version(self) -> None:
        version = self.request(mav.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
        if version is not None:
            self.learned.capabilities = version.capabilities
        self.request(PROTOCOL_VERSION)  # Releases before 5 did; refusing it is as good as an answer.

    def asks_for_modes(self) -> None:
        told = self.request(mav.MAVLINK_MSG_ID_AVAILABLE_MODES, 0 if self.modes_at_once else 1)
        while told is not None:
            self.learned.modes[told.custom_mode] = told.mode_name
            if told.mode_index >= told.number_modes:
                return
            if not self.modes_at_once:
                told = self.request(mav.MAVLINK_MSG_ID_AVAILABLE_MODES, told.mode_index + 1)
            else:
                told = self.kept.pop(0) if self.kept else self.wait(MESSAGE_TIMEOUT, "AVAILABLE_MODES")
        self.learned.steps.append(Step("modes", 1, "the last one did not come"))

    def asks_for_metadata(self) -> None:
        """The file that tells of all others, and that about parameters; both only if their checksums are told."""
        if (told := self.request(COMPONENT_METADATA)) is not None:
            uri = told.uri
        elif (told := self.request(COMPONENT_INFORMATION)) is not None:
            uri = told.general_metadata_uri
        else:
            return
        general = self.reads_file(uri)
        for about in () if general is None else general["metadataTypes"]:
            if about["type"] == TYPE_PARAMETER and about["uri"] and "fileCrc" in about:
                parameters = self.reads_file(about["uri"])
                for each in () if parameters is None else parameters["parameters"]:
                    self.learned.meanings[each["name"]] = each

    def reads_file(self, uri: str) -> dict[str, Any] | None:
        """A file of JSON, of the one version that is read; None: there is none, or it does not come."""
        try:
            content = self.files.download(uri)
        except FileNotReadError as refused:
            self.learned.steps.append(Step(f"file {uri}", 1, str(refused)))
            return None
        self.learned.steps.append(Step(f"file {uri}", 1, f"{len(content)} bytes"))
        self.learned.files[uri] = content
        read: dict[str, Any] = json.loads(content)
        return read if read["version"] == 1 else None

    def say(self, message: Message) -> None:
        self.link.send(message)

    def asks_for_gimbals(self) -> None:
        self.request(GIMBAL_MANAGER_INFORMATION)

    def asks_for_parameters(self) -> None:
        if self.ardupilot and not self.asks_for_a_parameter_file():
            return
        count = self.asks_for_the_list()
        tries = dict.fromkeys(set(range(count)) - self.seen, 0)
        while batch := [index for index in tries if index not in self.seen and tries[index] < PARAMETER_TRIES]:
            for index in batch[:PARAMETER_BATCH]:
                tries[index] += 1
                self.link.send(mav.MAVLink_param_request_read_message(self.system, AUTOPILOT, b"", index))
            while set(batch[:PARAMETER_BATCH]) - self.seen:
                if self.wait(PARAMETER_QUIET, "PARAM_VALUE", self.notes_parameter) is None:
                    break
        self.learned.steps.append(Step("parameters", 1, f"{len(self.seen)} of {count}"))

    def asks_for_a_parameter_file(self) -> bool:
        """Whether there is none, so that the list has to do; what is there is not read here."""
        path = b"@PARAM/param.pck?withdefaults=1"
        for attempt in range(1, FTP_TRIES + 1):
            said = FTP_HEADER.pack(attempt, 0, FTP_OPEN, len(path), 0, 0, 0) + path
            self.link.send(
                mav.MAVLink_file_transfer_protocol_message(0, self.system, AUTOPILOT, list(said.ljust(251, b"\0")))
            )
            answer = self.wait(FTP_TIMEOUT, "FILE_TRANSFER_PROTOCOL")
            if answer is not None:
                _, _, opcode, _, asked, *_ = FTP_HEADER.unpack(bytes(answer.payload[: FTP_HEADER.size]))
                what = answer.payload[FTP_HEADER.size] if opcode == FTP_NAK and asked == FTP_OPEN else opcode
                self.learned.steps.append(Step("parameter file", attempt, f"refused {what}"))
                return bool(what == FTP_FILE_NOT_FOUND)
        self.learned.steps.append(Step("parameter file", FTP_TRIES, "silence"))
        return True

    def asks_for_the_list(self) -> int:
        self.seen: set[int] = set()
        for attempt in range(1, LIST_TRIES + 1):
            self.link.send(mav.MAVLink_param_request_list_message(self.system, mav.MAV_COMP_ID_ALL))
            told = self.wait(LIST_TIMEOUT, "PARAM_VALUE", self.notes_parameter)
            if told is not None:
                self.learned.steps.append(Step("parameter list", attempt, f"{told.param_count}"))
                count = int(told.param_count)
                while len(self.seen) < count and self.wait(PARAMETER_QUIET, "PARAM_VALUE", self.notes_parameter):
                    pass
                return count
        self.learned.steps.append(Step("parameter list", LIST_TRIES, "silence"))
        return 0

    def notes_parameter(self, told: Message) -> bool:
        self.seen.add(told.param_index)
        self.learned.parameters[told.param_id] = told.param_value
        return True

    def tells_the_time(self) -> None:
        for _ in range(2):
            self.link.send(mav.MAVLink_system_time_message(1_700_000_000_000_000, 1000))

    # Plans.

    def reads_plan(self, kind: int) -> None:
        """All items of one mission type, one after the other."""

        def of_kind(told: Message) -> bool:
            return bool(told.mission_type == kind)

        name = f"plan {kind}"
        asked, count = self.plan_request(
            name, mav.MAVLink_mission_request_list_message(self.system, AUTOPILOT, kind), "MISSION_COUNT", of_kind
        )
        if count is None:
            return
        items: list[Message] = []
        for seq in range(count.count):
            request = mav.MAVLink_mission_request_int_message(self.system, AUTOPILOT, seq, kind)

            def wanted(told: Message, seq: int = seq) -> bool:
                return of_kind(told) and told.seq == seq

            _, item = self.plan_request(f"{name} item", request, "MISSION_ITEM_INT", wanted, ITEM_TIMEOUT)
            if item is None:
                return
            items.append(item)
        self.link.send(mav.MAVLink_mission_ack_message(self.system, AUTOPILOT, mav.MAV_MISSION_ACCEPTED, kind))
        self.learned.items[kind] = items
        self.learned.steps.append(Step(name, asked, f"{len(items)} items"))

    def writes_plan(self, items: list[Message]) -> str:
        """Uploads a mission; what the vehicle says to it at the end."""
        count = mav.MAVLink_mission_count_message(self.system, AUTOPILOT, len(items), mav.MAV_MISSION_TYPE_MISSION)
        kinds = ("MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK")
        asked, told = self.plan_request("write plan", count, kinds)
        while told is not None and told.get_type() != "MISSION_ACK":
            self.link.send(items[told.seq])
            told = self.wait(PLAN_TIMEOUT, kinds)
        answer = "silence" if told is None else str(told.type)
        self.learned.steps.append(Step("write plan", asked, answer))
        return answer

    def plan_request(
        self, name: str, request: Message, kinds: str | tuple[str, ...],
        wanted: Callable[[Message], bool] = lambda _: True, timeout: float = PLAN_TIMEOUT,
    ) -> tuple[int, Message | None]:  # fmt: skip
        for attempt in range(1, PLAN_RETRIES + 2):
            self.link.send(request)
            told = self.wait(timeout, kinds, wanted)
            if told is not None:
                return attempt, told
        self.learned.steps.append(Step(name, PLAN_RETRIES + 1, "silence"))
        return PLAN_RETRIES + 1, None

    # Commands.

    def request(self, message: int, index: float = 0.0) -> Message | None:
        """One message by REQUEST_MESSAGE; None if it is refused, or does not come."""
        kind = name_of(message)
        self.kept = []
        name = f"request {kind}"
        result = self.command(name, mav.MAV_CMD_REQUEST_MESSAGE, message, index, tries=COMMAND_TRIES, keeping=kind)
        if result != mav.MAV_RESULT_ACCEPTED:
            return None
        told = self.kept.pop(0) if self.kept else self.wait(MESSAGE_TIMEOUT, kind)
        if told is None:
            self.learned.steps.append(Step(name, 1, "accepted, and then nothing"))
        return told

    def command(self, name: str, command: int, *params: float, tries: int = 1, keeping: str = "") -> int | None:
        """The result of a COMMAND_LONG; None if none came. It is repeated with a confirmation that counts up."""
        seven = (*params, *[0.0] * (7 - len(params)))
        for attempt in range(tries):
            self.link.send(mav.MAVLink_command_long_message(self.system, AUTOPILOT, command, attempt, *seven))
            if (result := self.result_of(command, keeping)) is not None:
                self.learned.steps.append(Step(name, attempt + 1, f"result {result}"))
                return result
        self.learned.steps.append(Step(name, tries, "silence"))
        return None

    def goes_to(self, latitude: float, longitude: float, altitude: float) -> int | None:
        """Guided go-to, as ArduPilot gets it."""
        x, y = round(latitude * 1e7), round(longitude * 1e7)
        self.link.send(
            mav.MAVLink_command_int_message(
                self.system, AUTOPILOT, mav.MAV_FRAME_GLOBAL, mav.MAV_CMD_DO_REPOSITION, 0, 0,
                -1.0, mav.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE, 0.0, math.nan, x, y, altitude,
            )
        )  # fmt: skip
        return self.result_of(mav.MAV_CMD_DO_REPOSITION)

    def result_of(self, command: int, keeping: str = "") -> int | None:
        """The final result of a command; what came of kind `keeping` meanwhile is kept."""

        def of_it(told: Message) -> bool:
            if told.get_type() == keeping:
                self.kept.append(told)
                return False
            return bool(told.command == command)

        while (told := self.wait(COMMAND_TIMEOUT, ("COMMAND_ACK", keeping), of_it)) is not None:
            if told.result != mav.MAV_RESULT_IN_PROGRESS:
                return int(told.result)
        return None

    def changes_mode(self, custom_mode: int) -> bool:
        """ArduPilot's way: three tries, each watched for in heartbeats for 1.3 s."""
        for _ in range(3):
            self.command("mode", mav.MAV_CMD_DO_SET_MODE, mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, custom_mode)
            if self.sees(1.3, lambda: self.mode == custom_mode):
                return True
        return False

    def arms(self) -> bool:
        """Once, and watched for in heartbeats for 1.5 s."""
        self.command("arm", mav.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)
        return self.sees(1.5, lambda: self.armed)

    # The link.

    def sees(self, seconds: float, condition: Callable[[], bool]) -> bool:
        """Whether heartbeats tell so within a time."""
        end = self.link.now() + seconds
        while not condition():
            if self.link.now() >= end:
                return False
            self.wait(end - self.link.now(), "HEARTBEAT")
        return True

    def wait(
        self, seconds: float, kinds: str | Iterable[str], wanted: Callable[[Message], bool] = lambda _: True
    ) -> Message | None:
        """The next message of these kinds that is wanted; heartbeats are noted on the way."""
        names = (kinds,) if isinstance(kinds, str) else tuple(kinds)
        end = self.link.now() + seconds
        while (left := end - self.link.now()) > 0:
            told = self.link.receive(left)
            if told is None:
                return None
            if told.get_type() == "HEARTBEAT":
                self.armed = bool(told.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)
                self.flying = self.armed and told.system_status in (
                    mav.MAV_STATE_ACTIVE, mav.MAV_STATE_CRITICAL, mav.MAV_STATE_EMERGENCY,
                )  # fmt: skip
                self.mode = int(told.custom_mode)
            if told.get_type() in names and wanted(told):
                return told
        return None
