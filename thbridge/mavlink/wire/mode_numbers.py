"""Modes of a vehicle, and their numbers for ground stations.

ArduPilot's rovers have one number per mode. PX4 has a main mode and a sub mode. A vehicle that claims to be ArduPilot
uses ArduPilot's numbers. A generic vehicle uses PX4's numbers, because MAVSDK expects them from every autopilot except
ArduPilot.

Source: ArduPilot, Rover, `Mode::Number`; PX4, `px4_custom_mode.h`.
"""

from enum import StrEnum

from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.wire.dialect import mav


class Mode(StrEnum):
    """Flight mode of a vehicle. The value is the mode's name for people."""

    HOLD = "HOLD"
    GUIDED = "GUIDED"
    AUTO = "AUTO"
    RETURN = "RTL"
    MANUAL = "MANUAL"


_ARDUPILOT = {Mode.MANUAL: 0, Mode.HOLD: 4, Mode.AUTO: 10, Mode.RETURN: 11, Mode.GUIDED: 15}

_PX4_MANUAL, _PX4_ALTCTL, _PX4_POSCTL, _PX4_AUTO, _PX4_OFFBOARD = 1, 2, 3, 4, 6
_PX4 = {
    Mode.MANUAL: (_PX4_MANUAL, 0),
    Mode.HOLD: (_PX4_AUTO, 3),
    Mode.AUTO: (_PX4_AUTO, 4),
    Mode.RETURN: (_PX4_AUTO, 5),
    Mode.GUIDED: (_PX4_OFFBOARD, 0),
}

_ASKED_ARDUPILOT = {number: mode for mode, number in _ARDUPILOT.items()}
_ASKED_GENERIC = (
    {(number, 0): mode for mode, number in _ARDUPILOT.items()}
    | {numbers: mode for mode, numbers in _PX4.items()}
    # PX4 has several manual modes with different degrees of assistance.
    | {(_PX4_ALTCTL, 0): Mode.MANUAL, (_PX4_POSCTL, 0): Mode.MANUAL}
)
"""Modes by PX4's numbers and by ArduPilot's numbers. MAVProxy and mavutil send ArduPilot's numbers to every vehicle
that does not claim to be PX4. No number is ambiguous."""

_STANDARD = {Mode.RETURN: mav.MAV_STANDARD_MODE_SAFE_RECOVERY, Mode.AUTO: mav.MAV_STANDARD_MODE_MISSION}


def custom_mode(identity: AutopilotIdentity, mode: Mode) -> int:
    """Return the number of a mode for the field `custom_mode` of heartbeats."""
    if identity is AutopilotIdentity.ARDUPILOT:
        return _ARDUPILOT[mode]
    main, sub = _PX4[mode]
    return main << 16 | sub << 24


def requested_mode(identity: AutopilotIdentity, main: int, sub: int) -> Mode | None:
    """Return the mode with these numbers, or None.

    Args:
        identity: autopilot that the vehicle claims to have.
        main: a main mode, or `custom_mode` as in heartbeats.
        sub: sub mode of a main mode, otherwise 0.
    """
    if identity is AutopilotIdentity.ARDUPILOT:
        return _ASKED_ARDUPILOT.get(main) if sub == 0 else None
    if main > 0xFFFF:
        main, sub = main >> 16 & 0xFF, main >> 24
    return _ASKED_GENERIC.get((main, sub))


def standard_mode(mode: Mode) -> int:
    """Return a mode's code of MAV_STANDARD_MODE, or 0 if the standard does not have this mode."""
    return _STANDARD.get(mode, mav.MAV_STANDARD_MODE_NON_STANDARD)


def mode_from_standard(code: int) -> Mode | None:
    """Return the mode with a code of MAV_STANDARD_MODE, or None."""
    return next((mode for mode, standard in _STANDARD.items() if standard == code), None)


def shown_mode_name(autopilot: int, number: int) -> str:
    """Return the name of the mode in a heartbeat, or its number if it is not one of our modes."""
    identity = (
        AutopilotIdentity.ARDUPILOT if autopilot == mav.MAV_AUTOPILOT_ARDUPILOTMEGA else AutopilotIdentity.GENERIC
    )
    return next((mode.value for mode in Mode if custom_mode(identity, mode) == number), f"mode {number}")
