"""Constant messages of a vehicle about its capabilities and modes."""

from collections.abc import Callable, Mapping

from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.vehicle.boot_time import microseconds, milliseconds
from thbridge.mavlink.vehicle.component_files.metadata_files import GENERAL, MetadataFiles, checksum, uri
from thbridge.mavlink.vehicle.geodesy import MapProjection
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.extra_messages import ComponentInformation, ComponentMetadata, ProtocolVersion
from thbridge.mavlink.wire.mode_numbers import Mode, custom_mode, standard_mode

_CAPABILITIES = (
    mav.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mav.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
    | mav.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mav.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mav.MAV_PROTOCOL_CAPABILITY_FTP
    | mav.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    | mav.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
    | mav.MAV_PROTOCOL_CAPABILITY_MAVLINK2
)


class Capabilities:
    """Constant messages of one vehicle.

    Args:
        system: its system id.
        identity: autopilot that it claims to have.
        earth: map projection.
        files: its metadata files.
    """

    def __init__(self, system: int, identity: AutopilotIdentity, earth: MapProjection, files: MetadataFiles) -> None:
        self._system = system
        self._identity = identity
        self._earth = earth
        self._altitude = round(earth.altitude * 1000.0)
        self._files = files

    def makers(self) -> Mapping[int, Callable[[int], Message]]:
        """Return, by message id, the functions that make a message for a tick."""
        return {
            mav.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: self._gps_global_origin,
            mav.MAVLINK_MSG_ID_AUTOPILOT_VERSION: self._autopilot_version,
            mav.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: lambda _: mav.MAVLink_extended_sys_state_message(
                mav.MAV_VTOL_STATE_UNDEFINED, mav.MAV_LANDED_STATE_ON_GROUND
            ),
            # MAVLink sends versions times 100: frames of versions 1 and 2 are supported.
            ProtocolVersion.id: lambda _: ProtocolVersion(200, 100, 200, [0] * 8, [0] * 8),
            ComponentInformation.id: lambda tick: ComponentInformation(milliseconds(tick), *self._general(), 0, b""),
            ComponentMetadata.id: lambda tick: ComponentMetadata(milliseconds(tick), *self._general()),
            mav.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR: lambda _: mav.MAVLink_available_modes_monitor_message(0),
        }

    def available_mode(self, place: int) -> Message:
        """Return the message AVAILABLE_MODES for the mode with this index, which starts at 1."""
        mode = list(Mode)[place - 1]
        custom, standard = custom_mode(self._identity, mode), standard_mode(mode)
        return mav.MAVLink_available_modes_message(len(Mode), place, standard, custom, 0, mode.value.encode())

    def _gps_global_origin(self, tick: int) -> Message:
        place, now = self._earth.geo_point(0.0, 0.0), microseconds(tick)
        return mav.MAVLink_gps_global_origin_message(place.latitude, place.longitude, self._altitude, now)

    def _autopilot_version(self, tick: int) -> Message:
        # The version is 0, because ground stations would compare any other version with those of the real autopilot.
        nothing = [0] * 8
        return mav.MAVLink_autopilot_version_message(
            _CAPABILITIES, 0, 0, 0, 0, nothing, nothing, nothing, 0, 0, self._system
        )

    def _general(self) -> tuple[int, bytes]:
        """Return the checksum and URI of the general metadata file."""
        return checksum(self._files.contents[GENERAL]), uri(GENERAL).encode()
