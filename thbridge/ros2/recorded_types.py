"""Types of recorded messages in ROS 2, and the conversion of messages from ROS 1 to them and back.

The types are those of ROS 2 Jazzy if they exist there under the name that they have in ROS 1. Other types, for example
move_base_msgs/MoveBaseActionGoal, keep their fields from ROS 1; their headers then have no `seq`.
"""

from dataclasses import dataclass
from functools import cache

from rosbags.interfaces.typing import Typesdict
from rosbags.typesys import Stores, TypesysError, get_typestore
from rosbags.typesys.msg import normalize_msgtype
from rosbags.typesys.store import Typestore

from thbridge.ros.messages.foreign_types import register, types_in
from thbridge.ros2.copied_fields import LOG_OF_ROS1, LOG_OF_ROS2
from thbridge.ros2.message_copies import MessageCopy

DISTRIBUTION = "jazzy"
TF_OF_TF1 = "tf/msg/tfMessage"
_RENAMED = {TF_OF_TF1: "tf2_msgs/msg/TFMessage", LOG_OF_ROS1: LOG_OF_ROS2}
_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
_STUMBLES = (TypesysError, LookupError, AttributeError)
"""Errors of rosbags for definitions that it cannot use."""


@dataclass(frozen=True, slots=True)
class RecordedType:
    """Type of recorded messages in ROS 2.

    Attributes:
        name: for example "nav_msgs/msg/Odometry".
        definition: its definition and those of the types in it, as rosbag2 writes them.
        hash: hash of the type, for example "RIHS01_3cc9...".
        from_ros1: function that returns a message of ROS 1 as CDR, and raises ValueError for other bytes.
        to_ros1: function of the opposite direction.
    """

    name: str
    definition: str
    hash: str
    from_ros1: MessageCopy
    to_ros1: MessageCopy


def new_store() -> Typestore:
    """Return a new store of ROS 2's types."""
    return get_typestore(Stores.ROS2_JAZZY)


@cache
def _shared_store() -> Typestore:
    """Return the store for all types that do not contradict each other. A store takes about 20 ms."""
    return new_store()


@cache
def _standard_types() -> frozenset[str]:
    return frozenset(new_store().fielddefs)


@cache
def recorded_type(msgtype: str, definition: str) -> RecordedType:
    """Return the ROS 2 type for messages of a ROS 1 type.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        definition: definition in ROS 1 of the type and of the types in it.

    Raises:
        ValueError: the definition is not valid, or the type has no equivalent. The message is a clause.
    """
    store, source = _shared_store(), normalize_msgtype(msgtype)
    target = _RENAMED.get(source, source)
    ours = {name: store.fielddefs[name] for name in _TIMES} | types_in(msgtype, definition)
    if any(store.fielddefs.get(name, own) != own for name, own in ours.items() if name not in _standard_types()):
        store = new_store()  # Another publisher's definition has the same name.
    try:
        add_types(store, ours)
        text, _ = store.generate_msgdef(target, ros_version=2)
        return RecordedType(
            target,
            text,
            store.hash_rihs01(target),
            MessageCopy(ours, source, store.fielddefs, target, to_cdr=True),
            MessageCopy(store.fielddefs, target, ours, source, to_cdr=False),
        )
    except _STUMBLES as error:
        raise ValueError(f"{msgtype} has no equivalent in ROS 2 ({error})") from None


def add_types(store: Typestore, types: Typesdict) -> None:
    """Add the types of ROS 1 that a store of ROS 2 does not have."""
    register(store, {name: fields for name, fields in types.items() if name not in store.fielddefs})


def ros1_name(name: str) -> str:
    """Return the name that a type of ROS 2 has in ROS 1: "rcl_interfaces/msg/Log" is "rosgraph_msgs/msg/Log"."""
    return LOG_OF_ROS1 if name == LOG_OF_ROS2 else "tf2_msgs/msg/TFMessage" if name == TF_OF_TF1 else name
