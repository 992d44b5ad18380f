"""MAVLink's frames, and how vehicles stand, in the words of mavros: to its messages and back."""

from thbridge.ros.records import MavlinkFrame, VehicleState
from thbridge.ros.unpack import HeardFrame
from thbridge.wire.mavlink.dialect import crc_extra
from thbridge.wire.mavlink.frame import V1, V2, Frame
from thbridge.wire.mavlink.hub import Traffic
from thbridge.wire.mavlink.said import Status


def frame_record(traffic: Traffic) -> MavlinkFrame:
    """What a vehicle heard or said, for its topic."""
    frame = traffic.frame
    return MavlinkFrame(
        robot=traffic.robot,
        heard=traffic.heard,
        link=traffic.link,
        magic=frame.version,
        incompat_flags=frame.incompat_flags,
        compat_flags=frame.compat_flags,
        sequence=frame.sequence,
        system=frame.system,
        component=frame.component,
        message_id=frame.message_id,
        checksum=frame.checksum,
        payload=frame.payload,
    )


def state_record(robot: int, status: Status) -> VehicleState:
    """How a vehicle stands, for its topic."""
    return VehicleState(
        robot=robot,
        connected=status.connected,
        armed=status.armed,
        guided=status.guided,
        manual_input=status.manual_input,
        mode=status.mode,
        system_status=status.system_status,
    )


def frame_in(heard: HeardFrame) -> Frame:
    """The frame that a message holds, without its signature.

    Raises:
        ValueError: it is none, or one of a message that nobody here knows.
    """
    if heard.magic not in {V1, V2}:
        raise ValueError(f"no frame begins with {heard.magic}")
    seed = crc_extra(heard.message_id)
    if seed is None:
        raise ValueError(f"there is no message {heard.message_id}")
    frame = Frame(
        system=heard.system,
        component=heard.component,
        sequence=heard.sequence,
        message_id=heard.message_id,
        payload=heard.payload,
        seed=seed,
        version=heard.magic,
        incompat_flags=heard.incompat_flags,
        compat_flags=heard.compat_flags,
    )
    if frame.checksum != heard.checksum:
        raise ValueError(f"its checksum is {heard.checksum}, and should be {frame.checksum}")
    return frame.unsigned()
