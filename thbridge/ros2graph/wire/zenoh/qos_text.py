"""Quality of service as a part of liveliness keys. Each empty field is the default of rmw_zenoh.

Source: rmw_zenoh, liveliness_utils.cpp and qos.cpp.
"""

import re

from thbridge.ros2.qos import DeliveryReliability, Durability, QosProfile

_DEPTH = 42
"""Depth that rmw_zenoh writes as an empty field."""
_INFINITE = 9_223_372_036, 854_775_807
"""Seconds and nanoseconds of a duration without limit."""
_SECOND = 1_000_000_000

# Numbers have at most 10 digits, so that a hostile text cannot ask for arithmetic with huge numbers.
_NUMBER = r"[0-9]{0,10}"
_QOS = re.compile(
    rf"([012]?):([012]?):([012]?),({_NUMBER}):{_NUMBER},{_NUMBER}:({_NUMBER}),({_NUMBER}):[0-9]?,{_NUMBER},{_NUMBER}"
)


def write_qos(qos: QosProfile) -> str:
    """Return the text of a quality of service, for example "::,10:,:,:,," for the default of ROS 2."""
    reliability = "" if qos.reliability is DeliveryReliability.RELIABLE else f"{qos.reliability:d}"
    durability = "" if qos.durability is Durability.VOLATILE else f"{qos.durability:d}"
    depth = "" if qos.depth == _DEPTH else f"{qos.depth}"
    lifespan = _INFINITE if qos.lifespan_ns is None else divmod(qos.lifespan_ns, _SECOND)
    fields = ("" if part == limit else f"{part}" for part, limit in zip(lifespan, _INFINITE, strict=True))
    return f"{reliability}:{durability}:,{depth}:,:{','.join(fields)}:,,"


def read_qos(text: str) -> QosProfile | None:
    """Return the quality of service of a text. If the text is invalid, return None.

    Deadline and liveliness are not used. A history of all messages counts as "keep last" with the depth in the text.
    """
    found = _QOS.fullmatch(text)
    if found is None:
        return None
    reliability, durability, _, depth, seconds, rest = found.groups()
    lifespan = int(seconds or _INFINITE[0]), int(rest or _INFINITE[1])
    return QosProfile(
        int(depth or _DEPTH),
        DeliveryReliability.BEST_EFFORT if reliability == "2" else DeliveryReliability.RELIABLE,
        Durability.TRANSIENT_LOCAL if durability == "1" else Durability.VOLATILE,
        None if lifespan == _INFINITE else lifespan[0] * _SECOND + lifespan[1],
    )
