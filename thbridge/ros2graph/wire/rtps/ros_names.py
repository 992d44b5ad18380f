"""Names of ROS 2 on DDS: topics, types, and the hashes of types.

Source: "Topic and Service name mapping to DDS" of the ROS 2 design pages; rmw_dds_common, qos.cpp (hashes).
"""

import re

from thbridge.ros2graph.values.graph import EndpointRole

DISCOVERY_TOPIC = "ros_discovery_info"
DISCOVERY_TYPE = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
DISCOVERY_HASH = "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"

_NAME = re.compile(r"(/[A-Za-z0-9_]+)+")
_TYPE = re.compile(r"(\w+)::(msg|srv|action)::dds_::(\w+)_")
_HASH = re.compile(rb"(?:^|;)typehash=(RIHS01_[0-9a-f]{64})(?:;|$)")


def topic_name(name: str) -> str:
    """Return the DDS topic of a topic, for example "rt/chatter" for "/chatter"."""
    return f"rt{name}"


def request_topic(service: str) -> str:
    """Return the DDS topic of a service's requests."""
    return f"rq{service}Request"


def response_topic(service: str) -> str:
    """Return the DDS topic of a service's responses."""
    return f"rr{service}Reply"


def hash_data(type_hash: str) -> bytes:
    """Return the user data that declares the hash of a type."""
    return f"typehash={type_hash};".encode() if type_hash else b""


def hash_of(user_data: bytes) -> str:
    """Return the declared hash of a type; empty if there is none."""
    found = _HASH.search(user_data.rstrip(b"\x00"))
    return "" if found is None else found[1].decode()


def type_of(dds_type: str) -> str | None:
    """Return the type of a DDS type, for example "std_msgs/msg/String". None if it is no type of ROS."""
    found = _TYPE.fullmatch(dds_type)
    return None if found is None else "/".join(found.groups())


def role_and_name(topic: str, *, is_writer: bool) -> tuple[EndpointRole, str] | None:
    """Return the role of an endpoint, and the name of its topic or service. None if it has no role of its own.

    A server reads requests and a client writes them. Their other endpoint, for responses, has no role of its own.
    """
    kind, name = topic[:2], topic[2:]
    if not _NAME.fullmatch(name):
        return None
    if kind == "rt":
        return (EndpointRole.PUBLISHER if is_writer else EndpointRole.SUBSCRIPTION), name
    if kind == "rq" and name.endswith("Request"):
        return (EndpointRole.CLIENT if is_writer else EndpointRole.SERVER), name.removesuffix("Request")
    return None
