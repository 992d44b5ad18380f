"""Robot as a MAVLink 2 ground rover, without sockets and clocks. It receives messages and returns messages.

Source: the MAVLink developer guide, "Microservices".
"""

from collections.abc import Iterator

from thbridge.mavlink.values.options import AutopilotIdentity, VehicleOptions
from thbridge.mavlink.values.vehicle_interface import NO_READINGS, RobotReadings, Station, VehicleInterface
from thbridge.mavlink.vehicle.command.deprecated_messages import DeprecatedMessages
from thbridge.mavlink.vehicle.command.message_requests import MessageRequests
from thbridge.mavlink.vehicle.command.protocol import CommandProtocol
from thbridge.mavlink.vehicle.command.table import CommandTable
from thbridge.mavlink.vehicle.component_files.file_transfer import FileTransfer
from thbridge.mavlink.vehicle.component_files.metadata_files import MetadataFiles
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.mission.protocol import MissionProtocol
from thbridge.mavlink.vehicle.mission.run import MissionRun
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.mode.manual_control import ManualControl
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.mavlink.vehicle.mode.setpoints import ControlInputs
from thbridge.mavlink.vehicle.mode.state_machine import ModeStateMachine
from thbridge.mavlink.vehicle.parameter.own_parameters import FailsafeParameters
from thbridge.mavlink.vehicle.parameter.protocol import ParameterProtocol
from thbridge.mavlink.vehicle.parts import Microservice, TextSeverity
from thbridge.mavlink.vehicle.ping_timesync import PingTimesync
from thbridge.mavlink.vehicle.telemetry.capabilities import Capabilities
from thbridge.mavlink.vehicle.telemetry.status_texts import StatusTexts
from thbridge.mavlink.vehicle.telemetry.streams import Streams
from thbridge.mavlink.vehicle.telemetry.telemetry import Telemetry, TelemetryState, base_mode, default_streams
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.mode_numbers import Mode
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage, VehicleStatus


class Vehicle:
    """MAVLink vehicle of one robot.

    While the robot's software does not respond, the vehicle neither processes nor sends messages. So ground stations
    lose it like a real vehicle.

    Args:
        system: its system id, 1 to 250.
        robot: interface to the robot.
        options: options of the study.
    """

    def __init__(self, system: int, robot: VehicleInterface, options: VehicleOptions) -> None:
        self.system = system
        self._tick = 0
        self._readings = NO_READINGS
        self._shown = (Mode.HOLD, False)
        self._texts = StatusTexts()
        announce, earth, identity = self._texts.say, MapProjection(options.origin), options.identity
        ardupilot = identity is AutopilotIdentity.ARDUPILOT
        self._control = OperatorControl(robot, options.lost_after, announce)
        home, hand = HomePosition(robot, earth), ManualControl(robot, identity)
        plan = MissionRun(robot, home, earth, announce, ardupilot, options.visited_rooms)
        self._modes = ModeStateMachine(robot, hand, self._control, plan, home, options.failsafe, announce)
        self._streams = Streams(default_streams(options.position_rate, identity), system)
        parameters = FailsafeParameters(system, robot.parameters, self._control, self._modes)
        files = MetadataFiles(parameters)
        capabilities = Capabilities(system, identity, earth, files)
        self._telemetry = Telemetry(capabilities, identity, earth, home.position, plan.current)
        requests = MessageRequests(self._streams, self._telemetry, capabilities, lambda: self._state)
        commands = CommandTable(
            robot,
            self._modes,
            self._control,
            home,
            lambda: self._readings.base_in_map,
            earth,
            identity,
            requests.commands(),
        )
        self._parts: tuple[Microservice, ...] = (
            home,
            CommandProtocol(commands, self._control, self._modes, announce),
            ControlInputs(system, robot, self._modes, hand, self._control, earth, announce),
            DeprecatedMessages(commands, self._modes, self._control, home, earth, announce),
            MissionProtocol(plan, announce),
            ParameterProtocol(parameters, announce, ardupilot),
            FileTransfer(lambda: files.contents),
            PingTimesync(self._streams, earth),
        )

    @property
    def status(self) -> VehicleStatus:
        """Status as in mavros_msgs/State."""
        now = self._state
        bits = base_mode(now)
        return VehicleStatus(
            connected=self._readings.responsive,
            armed=bool(bits & mav.MAV_MODE_FLAG_SAFETY_ARMED),
            guided=bool(bits & mav.MAV_MODE_FLAG_GUIDED_ENABLED),
            manual_input=bool(bits & mav.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED),
            mode=now.mode.value,
            system_status=now.system_status,
        )

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Process a message to this vehicle or to all vehicles, and return the answers."""
        # Heartbeats count even while the robot does not respond, because its station is still there.
        if isinstance(message, mav.MAVLink_heartbeat_message):
            self._control.heartbeat(sender)
        elif self._readings.responsive:
            for part in self._parts:
                yield from part.handle_message(link, sender, message)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Advance by one tick and return the messages that are due."""
        self._tick, self._readings = tick, readings
        self._modes.step(tick, readings)
        for sentence in readings.announcements:
            self._texts.say(TextSeverity.INFO, sentence)
        for sentence in readings.participant_requests:
            self._texts.say(TextSeverity.NOTICE, sentence)
        if not readings.responsive:
            return
        yield from self._stream(tick)
        for part in self._parts:
            yield from part.step(tick, readings)
        yield from self._texts.step(tick)

    def keep_alive(self) -> Iterator[OutgoingMessage]:
        """Return a heartbeat with the current state, because stations lose a silent vehicle even during a pause."""
        if self._readings.responsive:
            yield from self._heartbeat()

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and the rates requested on it."""
        self._streams.forget(link)
        for part in self._parts:
            part.forget(link)

    @property
    def _state(self) -> TelemetryState:
        modes = self._modes
        return TelemetryState(self._tick, self._readings, modes.mode, modes.armed, self._control.commander_id)

    def _stream(self, tick: int) -> Iterator[OutgoingMessage]:
        """Yield the messages that are due. If mode or arming has changed, also yield a heartbeat."""
        state = self._state
        shown = (state.mode, state.armed)
        # Several links may get the same message, which is made only once.
        made: dict[int, Message | None] = {}
        for due in self._streams.due(tick):
            number = due.message
            if number not in made:
                made[number] = self._telemetry.message(number, state)
            message = made[number]
            if message is not None:
                is_heartbeat = number == mav.MAVLINK_MSG_ID_HEARTBEAT
                yield OutgoingMessage(message, due.link, to_inactive=is_heartbeat, except_links=due.except_links)
        if shown != self._shown and mav.MAVLINK_MSG_ID_HEARTBEAT not in made:
            yield from self._heartbeat()
        self._shown = shown

    def _heartbeat(self) -> Iterator[OutgoingMessage]:
        heartbeat = self._telemetry.message(mav.MAVLINK_MSG_ID_HEARTBEAT, self._state)
        if heartbeat is not None:
            yield OutgoingMessage(heartbeat, to_inactive=True)
