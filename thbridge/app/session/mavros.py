"""Conversion of MAVLink frames and vehicle states into messages of mavros and back."""

from thbridge.mavlink.wire.frames.frame import V1, V2, Frame
from thbridge.mavlink.wire.outgoing import VehicleStatus
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.ros.messages.records import MavlinkFrame, VehicleFrame, VehicleState


def frame_record(traffic: Traffic) -> VehicleFrame:
    """Return the record of a frame that a vehicle received or sent."""
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
    """Return the record of a vehicle's state."""
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
    """Return the frame in a message, without signature.

    Raises:
        ValueError: the message is not a frame, or the MAVLink message in the frame is unknown.
    """
    if message.magic not in {V1, V2}:
        raise ValueError(f"the frame begins with {message.magic}, which is not a start byte of MAVLink")
    # Imported here, because sessions without vehicles do not need the definitions of all messages.
    from thbridge.mavlink.wire.dialect import crc_extra  # noqa: PLC0415

    seed = crc_extra(message.message_id)
    if seed is None:
        raise ValueError(f"the MAVLink message {message.message_id} is unknown")
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
        raise ValueError(f"the checksum is {message.checksum}, but should be {frame.checksum}")
    return frame.unsigned()
