"""Small microservices: PING, TIMESYNC, GPS origin, REQUEST_DATA_STREAM."""

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.vehicle_interface import RobotReadings, Station
from thbridge.mavlink.vehicle.boot_time import microseconds
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.vehicle.parts import Microservice
from thbridge.mavlink.vehicle.telemetry.streams import OFF, Streams
from thbridge.mavlink.wire.dialect import BROADCAST, Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

_GROUPS: Mapping[int, tuple[int, ...]] = MappingProxyType(
    {
        mav.MAV_DATA_STREAM_RAW_SENSORS: (),
        mav.MAV_DATA_STREAM_EXTENDED_STATUS: (
            mav.MAVLINK_MSG_ID_SYS_STATUS,
            mav.MAVLINK_MSG_ID_GPS_RAW_INT,
            mav.MAVLINK_MSG_ID_MISSION_CURRENT,
            mav.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
            mav.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
        ),
        mav.MAV_DATA_STREAM_POSITION: (
            mav.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
            mav.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
        ),
        mav.MAV_DATA_STREAM_EXTRA1: (mav.MAVLINK_MSG_ID_ATTITUDE,),
        mav.MAV_DATA_STREAM_EXTRA2: (mav.MAVLINK_MSG_ID_VFR_HUD,),
        mav.MAV_DATA_STREAM_EXTRA3: (
            mav.MAVLINK_MSG_ID_BATTERY_STATUS,
            mav.MAVLINK_MSG_ID_SYSTEM_TIME,
            mav.MAVLINK_MSG_ID_EKF_STATUS_REPORT,
        ),
    }
)
"""Messages of each group of REQUEST_DATA_STREAM, as in ArduPilot."""


class PingTimesync(Microservice):
    """Answers of one vehicle to small requests. `Streams` stores the rates of each link.

    Args:
        streams: rates of its messages.
        earth: map projection.
    """

    def __init__(self, streams: Streams, earth: MapProjection) -> None:
        self._streams = streams
        self._earth = earth
        self._tick = 0

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Answer a request for one of these services."""
        match message:
            case mav.MAVLink_ping_message():
                # A PING with a target is an answer, not a request.
                if message.target_system == BROADCAST:
                    answer = mav.MAVLink_ping_message(message.time_usec, message.seq, sender.system, sender.component)
                    yield OutgoingMessage(answer, link)
            case mav.MAVLink_timesync_message():
                if message.tc1 == 0:
                    # A time of zero marks a request, so an answer must not contain it.
                    now = max(1, microseconds(self._tick) * 1000)
                    yield OutgoingMessage(mav.MAVLink_timesync_message(now, message.ts1), link)
            case mav.MAVLink_set_gps_global_origin_message():
                # The study sets the map's origin. A station that tries to change it gets the current origin.
                place = self._earth.geo_point(0.0, 0.0)
                altitude = round(self._earth.altitude * 1000.0)
                yield OutgoingMessage(
                    mav.MAVLink_gps_global_origin_message(place.latitude, place.longitude, altitude), link
                )
            case mav.MAVLink_request_data_stream_message():
                self._set_group(link, message)

    def step(self, tick: int, readings: RobotReadings) -> Iterable[OutgoingMessage]:
        """Store the time. No messages are sent."""
        self._tick = tick
        return ()

    def _set_group(self, link: LinkId, message: mav.MAVLink_request_data_stream_message) -> None:
        """Set the rate of a group of messages, or of all groups."""
        rate = message.req_message_rate if message.start_stop else 0
        ticks = max(1, round(TICKS_PER_SECOND / rate)) if rate else OFF
        if message.req_stream_id == mav.MAV_DATA_STREAM_ALL:
            members = tuple(member for group in _GROUPS.values() for member in group)
        else:
            members = _GROUPS.get(message.req_stream_id, ())
        for member in members:
            self._streams.change(link, member, ticks)
