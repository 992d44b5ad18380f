"""Conversion of MAVLink frames and vehicle states to mavros' messages and back."""

from thbridge.mavlink.wire.dialect import crc_extra
from thbridge.mavlink.wire.frames.frame import V1, V2, Frame
from thbridge.mavlink.wire.outgoing import VehicleStatus
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.ros.messages.records import MavlinkFrame, VehicleFrame, VehicleState


def frame_record(traffic: Traffic) -> VehicleFrame:
    """Return the record of a frame that a vehicle received or sent, for its topic."""
    frame = traffic.frame
    message = MavlinkFrame(
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
    return VehicleFrame(traffic.robot, traffic.incoming, message)


def state_record(robot: int, status: VehicleStatus) -> VehicleState:
    """Return the record of a vehicle's state, for its topic."""
    return VehicleState(
        robot=robot,
        connected=status.connected,
        armed=status.armed,
        guided=status.guided,
        manual_input=status.manual_input,
        mode=status.mode,
        system_status=status.system_status,
    )


def frame_in(message: MavlinkFrame) -> Frame:
    """Return the frame in a message, without its signature.

    Raises:
        ValueError: it is not a frame, or its MAVLink message is unknown.
    """
    if message.magic not in {V1, V2}:
        raise ValueError(f"a frame cannot begin with {message.magic}")
    seed = crc_extra(message.message_id)
    if seed is None:
        raise ValueError(f"there is no message {message.message_id}")
    frame = Frame(
        system=message.system,
        component=message.component,
        sequence=message.sequence,
        message_id=message.message_id,
        payload=message.payload,
        seed=seed,
        version=message.magic,
        incompat_flags=message.incompat_flags,
        compat_flags=message.compat_flags,
    )
    if frame.checksum != message.checksum:
        raise ValueError(f"its checksum is {message.checksum}, but should be {frame.checksum}")
    return frame.unsigned()
