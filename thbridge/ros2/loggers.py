"""Answers of a node's logger services.

Source: rcl_interfaces, srv/GetLoggerLevels and SetLoggerLevels, msg/LoggerLevel; ros2/rclcpp, node_logger.cpp.

The numbers of ROS's levels are those of Python: debug 10, info 20, warning 30, error 40, fatal 50; 0 is "unset".
"""

from collections.abc import Callable
from typing import Protocol, cast

from thbridge.ros2.distribution import Distribution

GET, SET = "get_logger_levels", "set_logger_levels"
GET_TYPE, SET_TYPE = "rcl_interfaces/srv/GetLoggerLevels", "rcl_interfaces/srv/SetLoggerLevels"
LEVELS = (0, 10, 20, 30, 40, 50)


class _Names(Protocol):
    names: list[str]


class _Level(Protocol):
    name: str
    level: int


class _Levels(Protocol):
    levels: list[_Level]


def answer_levels(types: Distribution, level_of: Callable[[str], int], request: bytes) -> bytes:
    """Answer a request for the levels of loggers. Raise ValueError for bytes that are no request.

    Args:
        types: types of the messages.
        level_of: returns the level of a logger, or 0 for an unknown logger.
        request: the request.
    """
    asked = cast(_Names, types.decode(f"{GET_TYPE}_Request", request))
    levels = [types.make("rcl_interfaces/msg/LoggerLevel", name=name, level=level_of(name)) for name in asked.names]
    return types.encoded(f"{GET_TYPE}_Response", levels=levels)


def answer_new_levels(types: Distribution, set_level: Callable[[str, int], str], request: bytes) -> bytes:
    """Answer a request to set the levels of loggers. Raise ValueError for bytes that are no request.

    Args:
        types: types of the messages.
        set_level: sets the level of a logger, and returns an empty text or the reason for a refusal.
        request: the request.
    """
    asked = cast(_Levels, types.decode(f"{SET_TYPE}_Request", request))
    results: list[object] = []
    for each in asked.levels:
        known = ", ".join(map(str, LEVELS))
        reason = (
            set_level(each.name, each.level)
            if each.level in LEVELS
            else f"there is no level {each.level}. Use one of these levels: {known}"
        )
        results.append(types.make("rcl_interfaces/msg/SetLoggerLevelsResult", successful=not reason, reason=reason))
    return types.encoded(f"{SET_TYPE}_Response", results=results)
