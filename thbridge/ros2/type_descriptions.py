"""Answers of the service `get_type_description` of each node.

Source: ros2/rcl, node.c (rcl_node_type_description_service_handle_request).

Differs: a node describes all types that thbridge knows, also those that it does not use. Sources have no comments.
"""

import re
from typing import Protocol, cast

from thbridge.ros2.distribution import Distribution
from thbridge.ros2.hashes import FullDescription, StructDescription

SERVICE = "get_type_description"
SERVICE_TYPE = "type_description_interfaces/srv/GetTypeDescription"

_MESSAGES = "type_description_interfaces/msg"
_HASH = re.compile(r"RIHS01_[0-9a-f]{64}")
_KINDS = ("msg", "srv", "action")


class _Request(Protocol):
    type_name: str
    type_hash: str
    include_type_sources: bool


def answer_type_description(types: Distribution, request: bytes) -> bytes:
    """Answer a request for the description of a type.

    Raises:
        ValueError: the bytes are not a request.
    """
    asked = cast(_Request, types.decode(f"{SERVICE_TYPE}_Request", request))
    description = _described(types, asked.type_name, asked.type_hash)
    name = f"{SERVICE_TYPE}_Response"
    if isinstance(description, str):
        return types.encoded(name, successful=False, failure_reason=description)
    message = types.make(
        f"{_MESSAGES}/TypeDescription",
        type_description=_struct(types, description["type_description"]),
        referenced_type_descriptions=[_struct(types, each) for each in description["referenced_type_descriptions"]],
    )
    sources = types.sources(asked.type_name) if asked.include_type_sources else []
    listed = [types.make(f"{_MESSAGES}/TypeSource", **source._asdict()) for source in sources]
    return types.encoded(name, successful=True, type_description=message, type_sources=listed)


def _described(types: Distribution, name: str, hash_: str) -> FullDescription | str:
    """Return the description of a type with this hash, or the reason why there is none."""
    if _HASH.fullmatch(hash_) is None:
        return f"{hash_[:80]!r} is not a type hash. A hash is RIHS01_ and 64 hexadecimal digits"
    parts = name.split("/")
    if len(parts) != 3 or parts[1] not in _KINDS:
        return f"{name[:80]!r} is not the name of a type. A name is for example nav_msgs/msg/Odometry"
    try:
        known = types.message(name).hash  # Services and actions have descriptions of the same form.
    except KeyError:
        return f"this node does not use the type {name[:80]}"
    if known != hash_:
        return f"this node uses the type {name} with the hash {known}"
    return types.description(name)


def _struct(types: Distribution, struct: StructDescription) -> object:
    fields = [
        types.make(
            f"{_MESSAGES}/Field",
            name=field["name"],
            type=types.make(f"{_MESSAGES}/FieldType", **field["type"]),
            default_value=field["default_value"],
        )
        for field in struct["fields"]
    ]
    return types.make(f"{_MESSAGES}/IndividualTypeDescription", type_name=struct["type_name"], fields=fields)
