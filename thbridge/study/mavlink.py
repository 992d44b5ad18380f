"""The section `mavlink` of a study: the robots as MAVLink vehicles, and the addresses of their links."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from sim.parameters import param
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.mavlink.values.options import (
    LONGEST_TIMEOUT,
    SHORTEST_TIMEOUT,
    AutopilotIdentity,
    Failsafe,
    GeoOrigin,
    VehicleOptions,
    VisitedRooms,
)
from thbridge.sockets.addresses import Address, UdpTarget, parse_address, parse_target

S = TypeVar("S")

_NORTHERNMOST = 85.0
"""Maximum latitude, degrees. The maps of ground stations end at this latitude."""
_LOWEST, _HIGHEST = -500.0, 9000.0
_ORIGIN_REMEDY = "Write degrees north, degrees east and meters above sea level, for example [51.5115, -0.116, 20.0]"


@dataclass(frozen=True, slots=True)
class MavlinkSection:
    """The robots as MAVLink vehicles."""

    on: bool = param(default=False, help="present every robot as a MAVLink vehicle, too")
    identity: AutopilotIdentity = param(
        AutopilotIdentity.GENERIC,
        "autopilot that the vehicles report; for ardupilot, ground stations offer more functions",
    )
    udp: tuple[str, ...] = param(
        ("127.0.0.1:14550", "127.0.0.1:14540"),
        "UDP addresses, HOST:PORT, of ground stations and programs; HOST:PORT/ROBOT receives only that robot",
    )
    udp_listen: str | None = param(
        None, "address, HOST:PORT, for clients that send the first UDP frame; if null, there is no address"
    )
    tcp: str | None = param(None, "address, HOST:PORT, for clients that connect by TCP; if null, there is no address")
    signing_key: Path | None = param(
        None, "path of a key file: frames are signed, and unsigned frames are refused; if null, there is no signing"
    )
    origin: tuple[float, float, float] = param(
        (51.5115, -0.116, 20.0),
        "WGS84 position of the map's point (0, 0) on earth; the map's y axis points north",
        "deg, deg, m",
    )
    lost_after: float = param(
        5.0,
        "time without a heartbeat after which a ground station counts as lost",
        "s",
        SHORTEST_TIMEOUT,
        LONGEST_TIMEOUT,
    )
    failsafe: Failsafe = param(Failsafe.STOP, "action of a robot when its ground station is lost")
    position_rate: float = param(
        5.0, "rate of position, attitude and speed messages, unless a client requests another rate", "Hz", 0.1, 50
    )
    visited_rooms: VisitedRooms = param(
        VisitedRooms.HALT,
        "reaction of a mission to an item in a room that was already visited: halt at this item, or skip it",
    )
    tlog: bool = param(default=False, help="also write all frames to a .tlog file next to the bag")

    @property
    def options(self) -> VehicleOptions:
        """Options of the vehicles, from this section."""
        return VehicleOptions(
            self.identity,
            GeoOrigin(*self.origin),
            self.lost_after,
            self.failsafe,
            self.position_rate,
            self.visited_rooms,
        )

    @property
    def targets(self) -> tuple[UdpTarget, ...]:
        """Addresses that receive the frames by UDP."""
        return tuple(target for target in map(parse_target, self.udp) if target is not None)


def faults_of_mavlink(loaded: Loaded[S], section: MavlinkSection, robots: int) -> Iterator[BadFile]:
    """Yield faults: invalid or repeated addresses, robots that do not exist, an origin outside the valid range."""
    taken: dict[Address, int] = {}
    for index, text in enumerate(section.udp):
        key = f"mavlink.udp[{index}]"
        target = parse_target(text)
        if target is None:
            yield loaded.fault(key, _no_address(text), "Write HOST:PORT, such as 127.0.0.1:14550, or HOST:PORT/ROBOT")
        elif taken.setdefault(target.address, index) != index:
            yield loaded.fault(key, f"{target.address} is in this list twice", "Write each address once")
        elif target.number is not None and target.number > robots:
            problem = f"there is no robot {target.number}: the study has {robots}"
            yield loaded.fault(key, problem, f"Write a number from 1 to {robots}, or increase `robots`")
    for name, listens, usual in (("udp_listen", section.udp_listen, 14555), ("tcp", section.tcp, 5760)):
        if listens is not None and parse_address(listens) is None:
            remedy = f"Write HOST:PORT, such as 127.0.0.1:{usual}, or null"
            yield loaded.fault(f"mavlink.{name}", _no_address(listens), remedy)
    latitude, longitude, altitude = section.origin
    if not abs(latitude) <= _NORTHERNMOST:
        problem = f"{latitude:g} degrees north is not within {-_NORTHERNMOST:g} to {_NORTHERNMOST:g}"
        yield loaded.fault("mavlink.origin", problem, _ORIGIN_REMEDY)
    if not abs(longitude) <= 180.0:
        yield loaded.fault("mavlink.origin", f"{longitude:g} degrees east is not within -180 to 180", _ORIGIN_REMEDY)
    if not _LOWEST <= altitude <= _HIGHEST:
        problem = f"{altitude:g} m above sea level is not within {_LOWEST:g} to {_HIGHEST:g}"
        yield loaded.fault("mavlink.origin", problem, _ORIGIN_REMEDY)


def _no_address(text: str) -> str:
    return f"{text!r} is not an address"
