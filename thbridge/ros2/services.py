"""Requests and responses of Nav2's services, as bytes. All functions raise ValueError for bytes that are no request.

Source: ros-navigation/navigation2, nav2_msgs/srv, amcl_node.cpp, map_server.cpp, costmap_2d_publisher.cpp;
ros2/rcl_interfaces, lifecycle_msgs.
"""

from collections.abc import Callable
from typing import Protocol, cast

import numpy as np

from thbridge.ros.clients import InvalidMessage, PoseEstimate, pose_estimate
from thbridge.ros.messages import types as ros1_types
from thbridge.ros2.distribution import Distribution

EMPTY = "std_srvs/srv/Empty"
SET_INITIAL_POSE = "nav2_msgs/srv/SetInitialPose"
GET_MAP = "nav_msgs/srv/GetMap"
LOAD_MAP = "nav2_msgs/srv/LoadMap"
CLEAR_COSTMAP = "nav2_msgs/srv/ClearEntireCostmap"
GET_COSTMAP = "nav2_msgs/srv/GetCostmap"
GET_STATE = "lifecycle_msgs/srv/GetState"

_POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
_GRID = "nav_msgs/msg/OccupancyGrid"
_ACTIVE = 3
"""lifecycle_msgs/msg/State, PRIMARY_STATE_ACTIVE."""
_UNDEFINED_FAILURE = 255
"""nav2_msgs/srv/LoadMap, RESULT_UNDEFINED_FAILURE."""


def _costs() -> np.ndarray[tuple[int], np.dtype[np.uint8]]:
    """Return a table: the cost for each of the 256 values of nav_msgs/OccupancyGrid, as unsigned bytes."""
    occupancy = np.arange(256)
    costs = np.clip(1 + -(-(occupancy - 1) * 251 // 97), 1, 252)
    costs[[0, 99, 100, 255]] = 0, 253, 254, 255
    return costs.astype(np.uint8)


_COSTS = _costs()


class _WithPose(Protocol):
    pose: object


class _Info(Protocol):
    map_load_time: object
    resolution: float
    width: int
    height: int
    origin: object


class _Stamped(Protocol):
    stamp: object


class _Grid(Protocol):
    header: _Stamped
    info: _Info
    data: np.ndarray[tuple[int], np.dtype[np.int8]]


def same_answer(types: Distribution, service: str) -> Callable[[bytes], bytes]:
    """Return a function that answers each request with the default response, after checking the request."""
    response = types.encode(f"{service}_Response", types.make(f"{service}_Response"))
    return _constant(types, service, response)


def active_state(types: Distribution) -> Callable[[bytes], bytes]:
    """Return a function that answers requests for a node's state: it is active."""
    name = f"{GET_STATE}_Response"
    state = types.make("lifecycle_msgs/msg/State", id=_ACTIVE, label="active")
    return _constant(types, GET_STATE, types.encode(name, types.make(name, current_state=state)))


def map_refused(types: Distribution) -> Callable[[bytes], bytes]:
    """Return a function that refuses requests for another map, because all robots must have the same map."""
    name = f"{LOAD_MAP}_Response"
    return _constant(types, LOAD_MAP, types.encode(name, types.make(name, result=_UNDEFINED_FAILURE)))


def map_answer(types: Distribution, grid: bytes) -> Callable[[bytes], bytes]:
    """Return a function that answers requests for the map.

    Args:
        types: types of the messages.
        grid: nav_msgs/OccupancyGrid of ROS 1.
    """
    # A response with one field has the same bytes as this field.
    return _constant(types, GET_MAP, types.from_ros1(ros1_types.OCCUPANCY_GRID, _GRID)(grid))


def _constant(types: Distribution, service: str, response: bytes) -> Callable[[bytes], bytes]:
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


def costmap_answer(types: Distribution) -> Callable[[bytes | None, bytes], bytes]:
    """Return a function that answers requests for a costmap.

    Its arguments are the last published nav_msgs/OccupancyGrid of ROS 1 (None if there is none), and the request. Costs
    from 1 to 252 are rounded, because the published message has only 98 values for them.
    """
    convert = types.from_ros1(ros1_types.OCCUPANCY_GRID, _GRID)

    def answer(published: bytes | None, request: bytes) -> bytes:
        types.decode(f"{GET_COSTMAP}_Request", request)
        name = f"{GET_COSTMAP}_Response"
        if published is None:
            return types.encode(name, types.make(name))
        grid = cast(_Grid, types.decode(_GRID, convert(published)))
        metadata = types.make(
            "nav2_msgs/msg/CostmapMetaData",
            map_load_time=grid.info.map_load_time,
            update_time=grid.header.stamp,
            layer="master",
            resolution=grid.info.resolution,
            size_x=grid.info.width,
            size_y=grid.info.height,
            origin=grid.info.origin,
        )
        costs = _COSTS[grid.data.view(np.uint8)]
        costmap = types.make("nav2_msgs/msg/Costmap", header=grid.header, metadata=metadata, data=costs)
        return types.encode(name, types.make(name, map=costmap))

    return answer
