"""How long commands of every kind wait for their acks, and which frames get lost, with robots that drive meanwhile.

The robots are a `thbridge play` of their own at the pace of the clock, recorded as always; the ground station is this
process, by UDP. Frames are counted by their sequence numbers where they come in.
"""

import asyncio
import math
import os
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import TICK
from tests.bench.budget import Budgets
from tests.bench.network.hall_for_fifty import hall_for_fifty
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import Program, until
from thbridge.mavlink.sockets.client import StationSocket, open_station
from thbridge.mavlink.station.ground_station import CommandAcked, CommandUnanswered, StationCommand
from thbridge.mavlink.wire.dialect import mav
from thbridge.sockets.addresses import Address

pytestmark = pytest.mark.bench

SECONDS = 20.0
SETTLING = 5.0
PAUSE = 0.015
"""Seconds from an ack to the next command."""

ASKED = (
    StationCommand(mav.MAV_CMD_REQUEST_MESSAGE, (mav.MAVLINK_MSG_ID_AUTOPILOT_VERSION,)),
    StationCommand(mav.MAV_CMD_SET_MESSAGE_INTERVAL, (mav.MAVLINK_MSG_ID_ATTITUDE, 200_000)),
    StationCommand(mav.MAV_CMD_GET_HOME_POSITION),
    StationCommand(mav.MAV_CMD_DO_CHANGE_SPEED, (1, 0.5)),
    StationCommand(mav.MAV_CMD_DO_GRIPPER),
)
"""What makes nobody drive; the last is not supported."""


def orders(driven: bool) -> Iterator[StationCommand]:
    """One command after the other, for one robot."""
    yield StationCommand(mav.MAV_CMD_COMPONENT_ARM_DISARM, (1,))
    for turn in cycle((-1, 1)):
        yield from ASKED
        if driven:
            there = (-1, 1, 0, math.nan, round(turn * 2e4), round(turn * 2e4))
            yield StationCommand(mav.MAV_CMD_DO_REPOSITION, there, mav.MAV_FRAME_LOCAL_OFFSET_NED)
            yield StationCommand(mav.MAV_CMD_DO_PAUSE_CONTINUE, (1,))


async def answered(link: StationSocket, robot: int, order: StationCommand) -> float:
    """Command a robot; seconds until it is answered."""
    begun = time.perf_counter()
    link.station.send_command(robot, order, time.monotonic())
    while True:
        for event in await link.poll():
            if isinstance(event, CommandAcked | CommandUnanswered) and (event.system, event.command) == (
                robot,
                order.number,
            ):
                return time.perf_counter() - begun


async def listen(link: StationSocket, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        await link.poll()


@dataclass(frozen=True, slots=True)
class Measured:
    """Processor seconds a second of the game's process, frames received and lost, milliseconds to acks by command."""

    share: float
    rate: float
    lost: int
    waits: dict[int, np.ndarray]

    @property
    def every(self) -> np.ndarray:
        return np.concatenate(list(self.waits.values()))

    def told(self) -> str:
        text = f"{1e3 * self.share:.0f} ms of processor time a second; {self.rate:.0f} frames/s, {self.lost} lost; "
        text += f"{len(self.every)} acks: {spread(self.every)}"
        for command, one in sorted(self.waits.items()):
            text += f"\n    {mav.enums['MAV_CMD'][command].name}: {spread(one)}"
        return text


async def measured(port: int, robots: int, driven: bool, process: int) -> Measured:
    async with open_station(Address("127.0.0.1", port), False, None) as link:
        while len(link.station.robots) < robots:
            await link.poll()
        said = {robot: orders(driven) for robot in range(1, robots + 1)}
        for robot, own in said.items():
            await answered(link, robot, next(own))
        await listen(link, SETTLING)
        frames = sum(each.frames for each in link.station.robots.values())
        waits: defaultdict[int, list[float]] = defaultdict(list)
        begun, spent = time.monotonic(), processor_time(process)
        for robot, own in cycle(said.items()):
            if time.monotonic() - begun > SECONDS:
                break
            order = next(own)
            waits[order.number].append(1e3 * await answered(link, robot, order))
            await listen(link, PAUSE)
        took, spent = time.monotonic() - begun, processor_time(process) - spent
        frames = sum(each.frames for each in link.station.robots.values()) - frames
        lost = sum(each.lost for each in link.station.robots.values())
    return Measured(spent / took, frames / took, lost, {command: np.array(one) for command, one in waits.items()})


def spread(waits: np.ndarray) -> str:
    return f"median {np.median(waits):.1f} ms, 95 % {np.percentile(waits, 95):.1f} ms, longest {waits.max():.1f} ms"


def processor_time(process: int) -> float:
    """Seconds that a process has had."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize("driven", [False, True], ids=["standing", "driving"])
@pytest.mark.parametrize("robots", [3, 10, 50])
def test_acks(robots: int, driven: bool, budgets: Budgets, tmp_path: Path) -> None:
    port = free_udp_port()
    (tmp_path / "study.yaml").write_text(f"map: {hall_for_fifty(tmp_path)}/\nrobots: {robots}\n")
    alone = ("--headless", "--outside", "TabUI", "--port", "0", "--bag", "a.bag", "--no-report")
    play = Program(tmp_path, "play", "study.yaml", "--mavlink", "--udp", f"127.0.0.1:{port}", *alone)
    try:
        until("treasures to be hidden", lambda: "treasures are hidden" in play.text, [play])
        found = asyncio.run(measured(port, robots, driven, play.process.pid))
        lag = ", too slow for it" if "lags behind" in play.text else ""
    finally:
        play.close()
    what = f"{robots} robots, {'driving' if driven else 'standing'}"
    print(f"\n{what}{lag}: {found.told()}")
    assert found.lost < 1e-3 * SECONDS * found.rate
    assert np.median(found.every) < 1e3 * TICK
    budgets.time(f"MAVLink: a second of a game, {what}, commands meanwhile", found.share)
