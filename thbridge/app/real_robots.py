"""SimR with real robots of a ROS graph: the same role, another team."""

from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack

import numpy as np

from sim.common.observations import TICKS_PER_SECOND
from thbridge.app.compose.recording import build_record, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import StudySetting
from thbridge.app.programs import SIMR, SimrOptions, run_at_server
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.simr_session import SimrSession
from thbridge.protocols.rosgraph.links import TopicHeader
from thbridge.protocols.text import legacy
from thbridge.recording.real_robots import FleetRecorder
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.topics import RosMessage
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.sockets.rosgraph.fleet import CALLER, Fleet
from thbridge.sockets.rosgraph.joining import GraphAddress
from thbridge.sockets.text.client import TextClient
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer


class _NoRecorder:
    """The recorder of a session that is not recorded."""

    def received(self, topic: TopicHeader, publisher: str, stamp_ns: int, data: bytes) -> None:
        """Take no notice."""

    def sent(self, message: RosMessage) -> None:
        """Take no notice."""


async def simr_with_real_robots(
    setting: StudySetting,
    options: SimrOptions,
    graph: GraphAddress,
    lost: Callable[[ConnectionLost], None],
    unreachable: Callable[[CannotListen], None],
    missing: Callable[[Sequence[str]], None],
) -> str | None:
    """Command real robots for the game until stopped; they stand when it ends.

    Args:
        setting: the study.
        options: of the program; the rate is that of real time.
        graph: the robots' ROS graph.
        lost: takes the reason when the connection to the text server is lost.
        unreachable: takes the reason why robots cannot connect to this node; it must raise.
        missing: takes new sentences about missing topics and nodes; at last an empty list.

    Returns:
        The keeper's reason for rejecting these robots, or None when stopped.

    Raises:
        BagNotWritten: the bag cannot be written; it is closed, the robots stand, and the program is over.
    """
    async with AsyncExitStack() as opened:
        recorder: FleetRecorder | None = None
        if options.bag is not None:
            writer = opened.enter_context(build_writer(setting, options.bag, CALLER))
            recorder = FleetRecorder(writer, build_record(setting, SIMR, [legacy.SIMR], ""))
        footprint = np.array(setting.study.world.footprint, dtype=np.float64)
        named = setting.study.fleet.names(setting.study.robots)
        stale_ns = round(setting.study.fleet.silence * 1e9)
        robots = [RemoteRobot(robot, each, CALLER, footprint, stale_ns) for robot, each in enumerate(named)]
        fleet = Fleet(graph, robots, recorder or _NoRecorder())
        opened.push_async_callback(fleet.stop)
        started = await fleet.start()
        if isinstance(started, CannotListen):
            unreachable(started)
        reported: list[str] = []

        def wait() -> bool:
            nonlocal reported
            if recorder is not None:
                recorder.flush()
            found = fleet.missing()
            news = [sentence for sentence in found if sentence not in reported]
            reported = found
            if news or not found:
                missing(news)
            return bool(found)

        if not (await run_ticks(wait, Pacer(1.0))).finished:
            return None
        role = build_simr(setting, fleet, round(setting.study.fleet.silence * TICKS_PER_SECOND))
        session = SimrSession(role, [] if recorder is None else [BagRecorder(recorder)])
        client = TextClient(role.name, options.token, options.host, options.port)
        await run_at_server(session, client, Pacer(1.0), lambda: role.rejection is not None, lost)
        await fleet.stop()
        if recorder is not None:
            recorder.flush()
        return role.rejection
