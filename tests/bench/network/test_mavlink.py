"""What it costs that fifty robots speak MAVLink: processor time, frames lost, and how long a command waits for its ack.

The hunt runs in this process at the pace of the clock. The ground station is another process: it hears every robot at
the usual rates and asks one after the other for a message that they do not send by themselves.
"""

import asyncio
import dataclasses
import json
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import TICK
from tests.bench.budget import Budgets
from tests.bench.network.hall_for_fifty import hall_for_fifty
from thbridge.app import play
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions
from thbridge.app.session.session import TickRecord
from thbridge.mavlink.sockets.server import MavlinkPorts
from thbridge.sockets.addresses import Address, UdpTarget
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

ROBOTS = 50
WARM_UP = 6.0
SECONDS = 26.0
TICK_MS = 1e3 * TICK

STATION = """
import asyncio, json, sys, time
from thbridge.sockets.addresses import Address
from thbridge.mavlink.sockets.client import open_station
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.station.ground_station import CommandAcked, CommandUnanswered

async def main():
    port, robots, seconds = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
    async with open_station(Address("127.0.0.1", port), False, None) as link:
        print("ready", flush=True)
        station = link.station
        while len(station.robots) < robots:
            await link.poll()
        until = time.monotonic() + 3.0
        while time.monotonic() < until:
            await link.poll()
        first = {each.system: each.frames for each in station.robots.values()}
        waits, asked, begun = [], 0, time.monotonic()
        while time.monotonic() - begun < seconds:
            robot, asked = asked % robots + 1, asked + 1
            sent = time.monotonic()
            station.request(robot, mav.MAVLINK_MSG_ID_AUTOPILOT_VERSION, sent)
            answered = False
            while not answered:
                for event in await link.poll():
                    answered = answered or isinstance(event, CommandAcked | CommandUnanswered) and event.system == robot
            waits.append(time.monotonic() - sent)
            pause = time.monotonic() + 0.013
            while time.monotonic() < pause:
                await link.poll()
        took = time.monotonic() - begun
        frames = sum(each.frames - first[each.system] for each in station.robots.values())
        lost = sum(each.lost for each in station.robots.values())
        print(json.dumps({"waits": waits, "frames": frames, "lost": lost, "took": took}))

asyncio.run(main())
"""


@pytest.mark.parametrize("recorded", [True, False], ids=["recorded", "unrecorded"])
@pytest.mark.parametrize("vehicles", ["none", "unheard", "heard"])
def test_fifty_robots(vehicles: str, recorded: bool, budgets: Budgets, tmp_path: Path) -> None:
    hall = hall_for_fifty(tmp_path)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    section = MavlinkSection(on=vehicles != "none")
    server = dataclasses.replace(Study().server, port=0)
    study = dataclasses.replace(Study(), map=f"{hall}/", robots=ROBOTS, server=server, mavlink=section)
    ports = MavlinkPorts((UdpTarget(Address("127.0.0.1", port)),), None, None) if section.on else None
    begun: tuple[float, float] | None = None
    ended = (0.0, 0.0)

    def watch(moment: TickRecord) -> None:
        nonlocal begun, ended
        now = (moment.tick * 0.02, time.process_time())
        if begun is None and now[0] >= WARM_UP:
            begun = now
        ended = now

    command = [sys.executable, "-c", STATION, str(port), str(ROBOTS), str(SECONDS - WARM_UP - 6.0)]
    station = subprocess.Popen(command, stdout=subprocess.PIPE, text=True) if vehicles == "heard" else None
    if station is not None and station.stdout is not None:
        assert station.stdout.readline() == "ready\n"
    setting = read_setting(study, Path())
    bag = tmp_path / "hunt.bag" if recorded else None
    options = PlayOptions(1.0, bag, frozenset({"TabUI"}), "", SECONDS, mavlink=ports)
    with pytest.raises(HuntUnfinished):
        asyncio.run(play.play(setting, (), options, lambda _: None, watch))
    assert begun is not None
    share = (ended[1] - begun[1]) / (ended[0] - begun[0])
    how = f"{vehicles}, {'recorded' if recorded else 'not recorded'}"
    print(f"\n{ROBOTS} robots, MAVLink: {how}: {1e3 * share:.0f} ms of processor time per simulated second")
    budgets.time(f"MAVLink: a second of {ROBOTS} robots, {how}", share)
    if station is not None:
        told, _ = station.communicate(timeout=60)
        heard = json.loads(told)
        waits = 1e3 * np.array(heard["waits"])
        print(
            f"{heard['frames'] / heard['took']:.0f} frames/s at the station, {heard['lost']} lost; {len(waits)} acks: "
            f"median {np.median(waits):.1f} ms, 95 % {np.percentile(waits, 95):.1f} ms, longest {waits.max():.1f} ms"
        )
        assert heard["lost"] == 0
        assert np.median(waits) < TICK_MS
