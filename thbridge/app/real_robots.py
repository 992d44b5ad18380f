"""SimR with real robots of a ROS 1 or ROS 2 graph in place of simulated robots."""

from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack
from dataclasses import replace
from functools import partial
from itertools import starmap
from pathlib import Path

import numpy as np

from sim.common.observations import TICKS_PER_SECOND
from sim.parameters import live_parameters
from thbridge.app.compose.recording import begin_recording, build_record, room_labels
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import StudySetting
from thbridge.app.programs import SIMR, SimrOptions, await_consent, run_at_server
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.simr_session import SimrSession
from thbridge.ros import names
from thbridge.ros.messages.stamps import TICK_NS
from thbridge.ros.reconfigure import described
from thbridge.ros.remote.changes import SettledState
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.remote.team import RemoteTeam
from thbridge.ros.topics import RosMessage
from thbridge.ros2graph.sockets.joining import NodeTaken
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.rosgraph.files.real_robots import FleetRecorder
from thbridge.rosgraph.sockets.fleet import Fleet
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.rosgraph.wire.links import TopicHeader
from thbridge.sockets.errors import CannotListen, CannotReach
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.study.real_robots import FleetSection
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire import legacy
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer


class HeldTraffic:
    """Recorder of a fleet's messages, which passes messages to a bag only after recording is allowed.

    Before, only the last message of each latched topic is stored, for example fixed transforms. A bag needs these
    messages, and robots send them only once.

    Attributes:
        recorder: recorder of the bag. If None, recording has not started, or the program does not record.
    """

    def __init__(self) -> None:
        self.recorder: FleetRecorder | None = None
        self._latched: dict[tuple[str, str], tuple[TopicHeader, str, int, bytes]] = {}
        self._latched_own: dict[str, RosMessage] = {}

    def received(self, topic: TopicHeader, publisher: str, stamp_ns: int, data: bytes) -> None:
        """Record a message. Before recording is allowed, store only latched messages."""
        if self.recorder is not None:
            self.recorder.received(topic, publisher, stamp_ns, data)
        elif topic.latched:
            self._latched[topic.name, publisher] = (topic, publisher, stamp_ns, data)

    def sent(self, message: RosMessage) -> None:
        """Record a message to a robot. Before recording is allowed, store only latched messages."""
        if self.recorder is not None:
            self.recorder.sent(message)
        elif message.topic.latched:
            self._latched_own[message.topic.name] = message

    def release(self, recorder: FleetRecorder) -> None:
        """Start recording: first the stored latched messages, then all following messages."""
        self.recorder = recorder
        for topic, publisher, stamp_ns, data in sorted(self._latched.values(), key=lambda kept: kept[2]):
            recorder.received(topic, publisher, stamp_ns, data)
        for message in self._latched_own.values():
            recorder.sent(message)
        self._latched.clear()
        self._latched_own.clear()

    def flush(self) -> None:
        """Write the pending messages. Raises BagNotWritten: the bag cannot be written."""
        if self.recorder is not None:
            self.recorder.flush()


def build_fleet(setting: StudySetting, graph: GraphAddress | Ros2Address, traffic: HeldTraffic) -> RemoteTeam:
    """Return the real robots of a study, before they join their graph."""
    section = setting.study.fleet
    (declared,) = live_parameters(FleetSection)
    offset = replace(described(declared), default=section.odom_time_offset)
    footprint = np.array(setting.study.world.footprint, dtype=np.float64)
    stale_ns = round(section.silence * 1e9)
    robot_of = partial(RemoteRobot, caller=names.FLEET, footprint=footprint, stale_ns=stale_ns)
    if isinstance(graph, Ros2Address):
        # The import is here because other robots do not need the types of ROS 2.
        from thbridge.app.real_nav2_robots import build_nav2_fleet  # noqa: PLC0415

        return build_nav2_fleet(setting, graph, robot_of, traffic, offset)
    robots = list(starmap(robot_of, enumerate(section.names(setting.study.robots))))
    return Fleet(graph, robots, traffic, offset)


async def simr_with_real_robots(
    setting: StudySetting,
    options: SimrOptions,
    graph: GraphAddress | Ros2Address,
    lost: Callable[[ConnectionLost], None],
    unreachable: Callable[[CannotListen | CannotReach | NodeTaken], None],
    missing: Callable[[Sequence[str]], None],
) -> str | None:
    """Command real robots for the game until the program is stopped. At the end, the robots stop.

    If the study asks for consent, nothing is recorded until the server reports that the participant has agreed.

    Args:
        setting: the study.
        options: options of the program; the rate must be 1 (real time).
        graph: the robots' ROS graph.
        lost: callback with the reason, called when the connection to the text server is lost.
        unreachable: callback with the reason why this program cannot join the graph. The callback must raise an
            exception.
        missing: callback with sentences about missing topics and nodes. It is called when the list of sentences
            changes, and at the end with an empty list.

    Returns:
        The reason why the keeper rejected these robots; None if the program was stopped.

    Raises:
        BagNotWritten: the bag cannot be written. It is closed, the robots stop, and the program ends.
    """
    async with AsyncExitStack() as opened:
        traffic = HeldTraffic()

        def record(bag: Path) -> None:
            writer = opened.enter_context(begin_recording(setting, bag, names.FLEET))
            opening = build_record(setting, SIMR, [legacy.SIMR], "")
            traffic.release(FleetRecorder(writer, opening, room_labels(setting)))

        fleet = build_fleet(setting, graph, traffic)
        opened.push_async_callback(fleet.stop)
        started = await fleet.start()
        if isinstance(started, CannotListen | CannotReach | NodeTaken):
            unreachable(started)
        asks = options.bag is not None and setting.consent is not None
        if options.bag is not None and not asks:
            record(options.bag)
        reported: SettledState[tuple[str, ...]] = SettledState(())
        ticks = 0

        def wait() -> bool:
            nonlocal ticks
            ticks += 1
            traffic.flush()
            fleet.tell_changes()
            found, before = tuple(fleet.missing()), reported.settled
            if fleet.joined and reported.take(found, ticks * TICK_NS):
                missing([sentence for sentence in found if sentence not in before])
            elif not found:
                missing([])
            return bool(found)

        if not (await run_ticks(wait, Pacer(1.0))).finished:
            return None
        timeout = round(setting.study.fleet.silence * TICKS_PER_SECOND)
        if options.bag is not None and asks:
            waited = await await_consent(build_simr(setting, fleet, timeout), options, lost)
            if not waited.granted:
                return waited.rejection
            record(options.bag)
        role = build_simr(setting, fleet, timeout)
        session = SimrSession(role, [] if traffic.recorder is None else [BagRecorder(traffic.recorder)])
        client = TextClient(role.name, options.token, options.host, options.port, key=options.key)
        await run_at_server(session, client, Pacer(1.0), lambda: role.rejection is not None, lost)
        await fleet.stop()
        traffic.flush()
        return role.rejection
