"""A ground station made of MAVSDK, run by MAVSDK's own Python: does what it is told, and prints what it saw as JSON.

Its standard input is one JSON object: `url` to listen at, `origin` as latitude and longitude, `robots`, whether they
say that they are `ardupilot`'s, the name of a `parameter` to set, and points to `drive` to and for a `mission`. The
last line of its output is another, what it saw.
"""

import asyncio
import json
import math
import os
import sys
import traceback
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from typing import Any, TypeVar

from mavsdk import ComponentType, Configuration
from mavsdk.asyncio import Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.mavlink_direct import MavlinkDirectAsync
from mavsdk.asyncio.plugins.mission import MissionAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.plugins.mission import MissionItem, MissionPlan
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavsdk.plugins.param import ParamError

PATIENCE = 60.0
NEAR = 0.35
METRES_OF_A_DEGREE = 111_319.5
"""Along the equator; near enough over a few meters, to say where to go and whether it is there."""

T = TypeVar("T")
Told = dict[str, Any]
Place = tuple[float, float]
"""Latitude and longitude, degrees."""

GLOBAL, GLOBAL_RELATIVE_INT, WAYPOINT = 0, 6, 16


def e7(angle: float) -> int:
    return round(angle * 1e7)


async def first(what: str, values: AsyncIterator[T], wanted: Callable[[T], bool] = lambda _: True) -> T:
    """The first value that is as wanted."""

    async def there() -> T:
        async for value in values:
            if wanted(value):
                return value
        raise EOFError(what)

    return await in_time(what, there())


async def in_time(what: str, awaited: Awaitable[T]) -> T:
    try:
        return await asyncio.wait_for(awaited, PATIENCE)
    except TimeoutError as error:
        raise TimeoutError(f"waited {PATIENCE} s for {what}") from error


class Earth:
    """Meters east and north of the map's origin as degrees."""

    def __init__(self, latitude: float, longitude: float) -> None:
        self.latitude, self.longitude = latitude, longitude
        self.shrunk = METRES_OF_A_DEGREE * math.cos(math.radians(latitude))

    def degrees(self, east: float, north: float) -> tuple[float, float]:
        return self.latitude + north / METRES_OF_A_DEGREE, self.longitude + east / self.shrunk

    def metres(self, latitude: float, longitude: float) -> tuple[float, float]:
        return (longitude - self.longitude) * self.shrunk, (latitude - self.latitude) * METRES_OF_A_DEGREE


class Plan:
    """A mission by MAVSDK's plugin of that name."""

    def __init__(self, system: Any) -> None:
        self.plugin = MissionAsync(system)

    async def upload(self, places: Sequence[Place]) -> None:
        items = [
            MissionItem(latitude_deg=place[0], longitude_deg=place[1], relative_altitude_m=0.0, is_fly_through=True)
            for place in places
        ]
        await self.plugin.upload_mission(MissionPlan(mission_items=items))

    async def download(self) -> list[Place]:
        plan = await self.plugin.download_mission()
        return [(item.latitude_deg, item.longitude_deg) for item in plan.mission_items]


class PlanAfterHome:
    """A mission by the plugin for raw ones: the other one does not know that ArduPilot's first item is home."""

    def __init__(self, system: Any) -> None:
        self.plugin = MissionRawAsync(system)

    async def upload(self, places: Sequence[Place]) -> None:
        home = RawItem(seq=0, frame=GLOBAL, command=WAYPOINT, current=1, autocontinue=1)
        items = [
            RawItem(seq=seq, frame=GLOBAL_RELATIVE_INT, command=WAYPOINT, autocontinue=1, x=e7(north), y=e7(east))
            for seq, (north, east) in enumerate(places, 1)
        ]
        await self.plugin.upload_mission([home, *items])

    async def download(self) -> list[Place]:
        return [(item.x / 1e7, item.y / 1e7) for item in (await self.plugin.download_mission())[1:]]


class Rover:
    """One robot, by the plugins that a script would use."""

    def __init__(self, system: Any, earth: Earth, ardupilot: bool) -> None:
        self.earth = earth
        self.action = ActionAsync(system)
        self.telemetry = TelemetryAsync(system)
        self.param = ParamAsync(system)
        self.plan = PlanAfterHome(system) if ardupilot else Plan(system)
        self.direct = MavlinkDirectAsync(system)

    async def where(self) -> tuple[float, float]:
        """East and north, meters, as it tells in the local frame."""
        place = await first("a local position", self.telemetry.subscribe_position_velocity_ned())
        return place.position.east_m, place.position.north_m

    async def reaches(self, east: float, north: float) -> None:
        def there(told: Any) -> bool:
            away = math.hypot(told.position.east_m - east, told.position.north_m - north)
            return away < NEAR and math.hypot(told.velocity.north_m_s, told.velocity.east_m_s) < 0.02

        await first(f"it to be at {east}, {north}", self.telemetry.subscribe_position_velocity_ned(), there)

    async def go_to(self, east: float, north: float) -> None:
        latitude, longitude = self.earth.degrees(east, north)
        await in_time("go-to to be accepted", self.action.goto_location(latitude, longitude, 0.0, math.nan))

    async def moves_home(self, east: float, north: float) -> None:
        await self.action.set_home(False, *self.earth.degrees(east, north), 0.0)
        while math.dist(await self.home(), (east, north)) > NEAR:
            await asyncio.sleep(0.05)

    async def home(self) -> tuple[float, float]:
        """East and north, meters, as it was told last."""
        home = await self.telemetry.home()
        return self.earth.metres(home.latitude_deg, home.longitude_deg)

    async def is_in(self, mode: str) -> None:
        await first(f"mode {mode}", self.telemetry.subscribe_flight_mode(), lambda told: told.name == mode)


async def heard(rover: Rover, kind: str, into: list[Told]) -> None:
    async for message in rover.direct.subscribe_message(kind):
        into.append(json.loads(message.fields_json))


async def looks_around(rover: Rover) -> Told:
    await first("all to be well", rover.telemetry.subscribe_health_all_ok(), lambda well: well)
    battery = await first("the battery", rover.telemetry.subscribe_battery())
    mode = await first("a mode", rover.telemetry.subscribe_flight_mode())
    return {
        "battery": battery.remaining_percent,
        "home": await rover.home(),  # known, or else all would not be well
        "at": await rover.where(),
        "mode": mode.name,
    }


async def sets_parameters(rover: Rover, name: str) -> Told:
    everything = await in_time("all parameters", rover.param.get_all_params())
    before = await rover.param.get_param_float(name)
    await rover.param.set_param_float(name, before * 1.5)
    told: Told = {
        "all": {param.name: param.value for param in everything.float_params},
        "integers": len(everything.int_params),
        "before": before,
        "after": await rover.param.get_param_float(name),
    }
    try:
        await rover.param.get_param_float("NO_SUCH_NAME")
    except ParamError as error:
        told["unknown"] = str(error)
    return told


async def drives(rover: Rover, way: Sequence[tuple[float, float]]) -> Told:
    """Arms, goes to a point, is stopped on the way to another, and goes there after all."""
    told: Told = {"armed before": await first("the armed bit", rover.telemetry.subscribe_armed())}
    local: list[Told] = []
    globe: list[Told] = []
    listening = [
        asyncio.create_task(heard(rover, "LOCAL_POSITION_NED", local)),
        asyncio.create_task(heard(rover, "GLOBAL_POSITION_INT", globe)),
    ]
    await in_time("arming", rover.action.arm())
    await first("it to be armed", rover.telemetry.subscribe_armed(), lambda armed: armed)
    await in_time("a new home", rover.moves_home(*way[0]))
    await rover.go_to(*way[0])
    await rover.reaches(*way[0])
    await rover.go_to(*way[1])
    away = rover.telemetry.subscribe_position_velocity_ned()
    await first("it to move", away, lambda it: math.hypot(it.velocity.north_m_s, it.velocity.east_m_s) > 0.1)
    await in_time("hold", rover.action.hold())
    await rover.is_in("HOLD")
    still = rover.telemetry.subscribe_position_velocity_ned()
    await first("it to stand", still, lambda it: math.hypot(it.velocity.north_m_s, it.velocity.east_m_s) < 0.02)
    told["held at"] = await rover.where()
    for task in listening:
        task.cancel()
    return {**told, "local": local, "global": globe}


async def runs_a_mission(rover: Rover, way: Sequence[tuple[float, float]]) -> Told:
    """Uploads, downloads, runs and clears a mission."""
    places = [rover.earth.degrees(*point) for point in way]
    await in_time("arming", rover.action.arm())
    await in_time("the upload", rover.plan.upload(places))
    back = await in_time("the download", rover.plan.download())
    seen: list[tuple[int, int]] = []

    async def followed() -> None:
        async for progress in rover.plan.plugin.subscribe_mission_progress():
            seen.append((progress.current, progress.total))

    following = asyncio.create_task(followed())
    await in_time("the mission to start", rover.plan.plugin.start_mission())
    await rover.is_in("MISSION")
    await rover.reaches(*way[-1])
    while not await rover.plan.plugin.is_mission_finished():
        await asyncio.sleep(0.05)

    async def completed() -> None:
        while not seen or seen[-1][0] != seen[-1][1]:
            await asyncio.sleep(0.05)

    await in_time("the progress to be told to its end", completed())
    following.cancel()
    await in_time("clearing", rover.plan.plugin.clear_mission())
    left = await in_time("the empty download", rover.plan.download())
    return {"sent": places, "downloaded": back, "progress": seen, "ended at": await rover.where(), "left": len(left)}


async def plays(orders: Told) -> Told:
    earth = Earth(*orders["origin"])
    async with Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION)) as mavsdk:
        await mavsdk.add_any_connection(orders["url"])

        async def discovered() -> None:
            while len(await mavsdk.get_systems()) < orders["robots"]:
                await asyncio.sleep(0.02)

        await in_time("the robots", discovered())
        systems = {await system.get_system_id(): system for system in await mavsdk.get_systems()}
        rovers = {number: Rover(system, earth, orders["ardupilot"]) for number, system in sorted(systems.items())}
        told: Told = {"systems": sorted(systems)}
        told["around"] = dict(zip(rovers, await asyncio.gather(*map(looks_around, rovers.values())), strict=True))
        told["types"] = [(await system.vehicle_type()).name for system in systems.values()]
        driver, runner, other = (rovers[number] for number in (1, 2, 3))
        told["parameters"], told["drive"], told["mission"] = await asyncio.gather(
            sets_parameters(other, orders["parameter"]),
            drives(driver, orders["drive"]),
            runs_a_mission(runner, orders["mission"]),
        )
        await in_time("disarming", driver.action.disarm())
        await first("it to be disarmed", driver.telemetry.subscribe_armed(), lambda armed: not armed)
        return told


if __name__ == "__main__":
    try:
        print(json.dumps(asyncio.run(plays(json.load(sys.stdin)))), flush=True)
    except BaseException:
        traceback.print_exc()
        os._exit(1)  # threads of MAVSDK's may wait for ever
