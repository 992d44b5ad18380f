"""A script of MAVSDK's that sends a robot one mission and reads it back, again and again until both came through.

Its standard input is one JSON object: `url` to listen at, the number of the `robot`, and `places` as whole latitude
and longitude. The last line of its output is another: the places that were `read`, and how many `tries` each took.
"""

import asyncio
import json
import os
import sys
import traceback
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from mavsdk import ComponentType, Configuration
from mavsdk.asyncio import Mavsdk
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.plugins.mission_raw import MissionItem, MissionRawError

GLOBAL_RELATIVE_INT, WAYPOINT = 6, 16
TRIES = 20

T = TypeVar("T")


async def until_done(do: Callable[[], Awaitable[T]]) -> tuple[T, int]:
    """What it gives in the end, and how many tries that took: MAVSDK itself gives up after some seconds of silence."""
    for number in range(1, TRIES):
        try:
            return await do(), number
        except MissionRawError:
            await asyncio.sleep(0.5)
    return await do(), TRIES


async def plays(orders: dict[str, Any]) -> dict[str, Any]:
    async with Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION)) as mavsdk:
        await mavsdk.add_any_connection(orders["url"])
        while True:
            systems = {await system.get_system_id(): system for system in await mavsdk.get_systems()}
            if orders["robot"] in systems:
                break
            await asyncio.sleep(0.05)
        plugin = MissionRawAsync(systems[orders["robot"]])
        items = [
            MissionItem(
                seq=seq, frame=GLOBAL_RELATIVE_INT, command=WAYPOINT, current=int(seq == 0), autocontinue=1, x=x, y=y
            )
            for seq, (x, y) in enumerate(orders["places"])
        ]
        _, up = await until_done(lambda: plugin.upload_mission(items))
        read, down = await until_done(plugin.download_mission)
        return {"read": [(item.x, item.y) for item in read], "tries": (up, down)}


if __name__ == "__main__":
    try:
        print(json.dumps(asyncio.run(plays(json.load(sys.stdin)))), flush=True)
    except BaseException:
        traceback.print_exc()
        os._exit(1)  # threads of MAVSDK's may wait for ever
