"""Requests and responses of the services of amcl and map_server, as bytes.

All functions raise ValueError for bytes that are no request.

Source: ros-navigation/navigation2, nav2_msgs/srv, amcl_node.cpp, map_server.cpp.
"""

from collections.abc import Callable
from typing import Protocol, cast

from thbridge.ros.clients import InvalidMessage, PoseEstimate, pose_estimate
from thbridge.ros.messages import types as ros1_types
from thbridge.ros2.distribution import Distribution

EMPTY = "std_srvs/srv/Empty"
SET_INITIAL_POSE = "nav2_msgs/srv/SetInitialPose"
GET_MAP = "nav_msgs/srv/GetMap"
LOAD_MAP = "nav2_msgs/srv/LoadMap"

_POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
_GRID = "nav_msgs/msg/OccupancyGrid"
_UNDEFINED_FAILURE = 255
"""nav2_msgs/srv/LoadMap, RESULT_UNDEFINED_FAILURE."""


class _WithPose(Protocol):
    pose: object


def constant_answer(types: Distribution, service: str, **fields: object) -> Callable[[bytes], bytes]:
    """Return a function that answers each request with the same response, after checking the request.

    Args:
        types: types of the messages.
        service: type of the service.
        fields: fields of the response that do not have their default values.
    """
    return _always(types, service, types.encoded(f"{service}_Response", **fields))


def map_refused(types: Distribution) -> Callable[[bytes], bytes]:
    """Return a function that refuses requests for another map, because all robots must have the same map."""
    return constant_answer(types, LOAD_MAP, result=_UNDEFINED_FAILURE)


def map_answer(types: Distribution, grid: bytes) -> Callable[[bytes], bytes]:
    """Return a function that answers requests for the map.

    Args:
        types: types of the messages.
        grid: nav_msgs/OccupancyGrid of ROS 1.
    """
    # A response with one field has the same bytes as this field.
    return _always(types, GET_MAP, types.from_ros1(ros1_types.OCCUPANCY_GRID, _GRID)(grid))


def _always(types: Distribution, service: str, response: bytes) -> Callable[[bytes], bytes]:
    def answer(request: bytes) -> bytes:
        types.decode(f"{service}_Request", request)
        return response

    return answer


def initial_pose(types: Distribution) -> Callable[[bytes], PoseEstimate | InvalidMessage]:
    """Return a function that reads requests to set the initial pose."""
    convert = types.to_ros1(_POSE, ros1_types.POSE_WITH_COVARIANCE)

    def read(request: bytes) -> PoseEstimate | InvalidMessage:
        asked = cast(_WithPose, types.decode(f"{SET_INITIAL_POSE}_Request", request))
        return pose_estimate(convert(types.encode(_POSE, asked.pose)))

    return read
