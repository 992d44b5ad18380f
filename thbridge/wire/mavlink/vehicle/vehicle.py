"""A robot as a MAVLink 2 ground rover, without sockets and clocks: messages in, messages out.

Source: the MAVLink developer guide, "Microservices".
"""

from collections.abc import Iterator

from thbridge.wire.mavlink.dialect import Message, mav
from thbridge.wire.mavlink.modes import Mode
from thbridge.wire.mavlink.options import AutopilotIdentity, VehicleOptions
from thbridge.wire.mavlink.outgoing import LinkId, OutgoingMessage, VehicleStatus
from thbridge.wire.mavlink.vehicle.command.deprecated_messages import DeprecatedMessages
from thbridge.wire.mavlink.vehicle.command.message_requests import MessageRequests
from thbridge.wire.mavlink.vehicle.command.protocol import CommandProtocol
from thbridge.wire.mavlink.vehicle.command.table import CommandTable
from thbridge.wire.mavlink.vehicle.component_files.file_transfer import FileTransfer
from thbridge.wire.mavlink.vehicle.component_files.metadata_files import MetadataFiles
from thbridge.wire.mavlink.vehicle.geodesy import MapProjection
from thbridge.wire.mavlink.vehicle.mission.protocol import MissionProtocol
from thbridge.wire.mavlink.vehicle.mission.run import MissionRun
from thbridge.wire.mavlink.vehicle.mode.home import HomePosition
from thbridge.wire.mavlink.vehicle.mode.manual_control import ManualControl
from thbridge.wire.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.wire.mavlink.vehicle.mode.setpoints import ControlInputs
from thbridge.wire.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.wire.mavlink.vehicle.parameter.own_parameters import FailsafeParameters
from thbridge.wire.mavlink.vehicle.parameter.protocol import ParameterProtocol
from thbridge.wire.mavlink.vehicle.parts import Microservice, TextSeverity
from thbridge.wire.mavlink.vehicle.ping_timesync import PingTimesync
from thbridge.wire.mavlink.vehicle.telemetry.capabilities import Capabilities
from thbridge.wire.mavlink.vehicle.telemetry.status_texts import StatusTexts
from thbridge.wire.mavlink.vehicle.telemetry.streams import Streams
from thbridge.wire.mavlink.vehicle.telemetry.telemetry import Telemetry, TelemetryState, base_mode, default_streams
from thbridge.wire.mavlink.vehicle_interface import NOTHING_KNOWN, RobotReadings, Station, VehicleInterface


class Vehicle:
    """MAVLink vehicle of one robot.

    While the robot's software does not respond, the vehicle neither handles nor sends messages, so that ground stations
    lose it as they would lose a real one.

    Args:
        system: its system id, 1 to 250.
        robot: interface to the robot.
        options: options of the study.
    """

    def __init__(self, system: int, helm: VehicleInterface, options: VehicleOptions) -> None:
        self.system = system
        self._tick = 0
        self._readings = NOTHING_KNOWN
        self._shown = (Mode.HOLD, False)
        self._texts = StatusTexts()
        announce, earth, identity = self._texts.say, MapProjection(options.origin), options.identity
        ardupilot = identity is AutopilotIdentity.ARDUPILOT
        self._command = OperatorControl(helm, options.lost_after)
        home, hand = HomePosition(helm, earth), ManualControl(helm, identity)
        plan = MissionRun(helm, home, earth, announce, ardupilot)
        self._conduct = ModeStateMachine(helm, hand, self._command, plan, home, options.failsafe, announce)
        self._streams = Streams(default_streams(options.position_rate, identity), system)
        parameters = FailsafeParameters(system, helm, self._command, self._conduct)
        files = MetadataFiles(parameters)
        particulars = Capabilities(system, identity, earth, files)
        self._telemetry = Telemetry(particulars, identity, earth, home.position, plan.current)
        requests = MessageRequests(self._streams, self._telemetry, particulars, lambda: self._standing)
        repertoire = CommandTable(
            helm,
            self._conduct,
            self._command,
            home,
            lambda: self._readings.base_in_map,
            earth,
            identity,
            requests.commands(),
        )
        self._parts: tuple[Microservice, ...] = (
            home,
            CommandProtocol(repertoire, self._command, self._conduct, announce),
            ControlInputs(system, helm, self._conduct, self._command, earth, announce),
            DeprecatedMessages(repertoire, self._conduct, self._command, home, earth, announce),
            MissionProtocol(plan, announce),
            ParameterProtocol(parameters, announce, ardupilot),
            FileTransfer(lambda: files.contents),
            PingTimesync(self._streams, earth),
        )

    @property
    def status(self) -> VehicleStatus:
        """Status as in mavros_msgs/State."""
        now = self._standing
        bits = base_mode(now)
        return VehicleStatus(
            connected=self._readings.answers,
            armed=bool(bits & mav.MAV_MODE_FLAG_SAFETY_ARMED),
            guided=bool(bits & mav.MAV_MODE_FLAG_GUIDED_ENABLED),
            manual_input=bool(bits & mav.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED),
            mode=now.mode.value,
            system_status=now.system_status,
        )

    def hear(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Handle a message to this vehicle, or to all, and return the answers."""
        if isinstance(message, mav.MAVLink_heartbeat_message):
            self._command.heartbeat(sender)
        elif self._readings.answers:
            for part in self._parts:
                yield from part.hear(link, sender, message)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Advance by one tick and return the messages that are due."""
        self._tick, self._readings = tick, readings
        self._conduct.step(tick, readings)
        for sentence in readings.news:
            self._texts.say(TextSeverity.INFO, sentence)
        for sentence in readings.asked:
            self._texts.say(TextSeverity.NOTICE, sentence)
        if not readings.answers:
            return
        yield from self._stream(tick)
        for part in self._parts:
            yield from part.step(tick, readings)
        yield from self._texts.step(tick)

    def keep_alive(self) -> Iterator[OutgoingMessage]:
        """Return a heartbeat with the present state, for a time without ticks."""
        if self._readings.answers:
            yield from self._heartbeat()

    def forget(self, link: LinkId) -> None:
        """Forget a closed link, with the rates that were requested on it."""
        self._streams.forget(link)
        for part in self._parts:
            part.forget(link)

    @property
    def _standing(self) -> TelemetryState:
        conduct = self._conduct
        return TelemetryState(self._tick, self._readings, conduct.mode, conduct.armed, self._command.number)

    def _stream(self, tick: int) -> Iterator[OutgoingMessage]:
        """Yield the messages that are due, and a heartbeat at once when mode or arming has changed."""
        standing = self._standing
        shown = (standing.mode, standing.armed)
        made: dict[int, Message | None] = {}
        for due in self._streams.due(tick):
            number = due.message
            if number not in made:
                made[number] = self._telemetry.message(number, standing)
            message = made[number]
            if message is not None:
                is_heartbeat = number == mav.MAVLINK_MSG_ID_HEARTBEAT
                yield OutgoingMessage(message, due.link, to_sleepers=is_heartbeat, besides=due.besides)
        if shown != self._shown and mav.MAVLINK_MSG_ID_HEARTBEAT not in made:
            yield from self._heartbeat()
        self._shown = shown

    def _heartbeat(self) -> Iterator[OutgoingMessage]:
        heartbeat = self._telemetry.message(mav.MAVLINK_MSG_ID_HEARTBEAT, self._standing)
        if heartbeat is not None:
            yield OutgoingMessage(heartbeat, to_sleepers=True)
