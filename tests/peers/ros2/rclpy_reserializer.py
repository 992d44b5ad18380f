"""Read messages in CDR with rclpy's generated types, and write them again.

Each line on stdin is the name of a type and a message in hexadecimal digits. Each line on stdout is the message that
rclpy wrote.
"""

import sys
from functools import cache
from importlib import import_module

from rclpy.serialization import deserialize_message, serialize_message


@cache
def class_of(name: str) -> type:
    """Return the class of a message, or of a part of a service or action."""
    package, kind, word = name.split("/")
    module = import_module(f"{package}.{kind}")
    whole, *part = word.split("_")
    if kind == "msg":
        return getattr(module, word)
    if kind == "srv":
        return getattr(getattr(module, whole), part[0])
    action = getattr(module, whole)
    match part:
        case [("Goal" | "Result" | "Feedback") as only]:
            return getattr(action, only)
        case ["FeedbackMessage"]:
            return action.Impl.FeedbackMessage
        case [service, end]:
            return getattr(getattr(action.Impl, f"{service}Service"), end)
    raise ValueError(name)


for line in sys.stdin:
    name, message = line.split()
    print(serialize_message(deserialize_message(bytes.fromhex(message), class_of(name))).hex(), flush=True)
