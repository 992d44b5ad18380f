"""Requests and responses of the services of Nav2's costmaps, and of planner_server's is_path_valid, as bytes.

All functions raise ValueError for bytes that are no request.

Source: ros-navigation/navigation2, nav2_msgs/srv, nav2_costmap_2d/src (clear_costmap_service.cpp, costmap_2d_ros.cpp,
costmap_2d_publisher.cpp), nav2_planner/src/planner_server.cpp.
Differences from Nav2: poses must be in the frame of the map. A square includes all cells that it touches.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, cast

from sim.common.geometry import Pose2
from sim.inputs import ClearCostmapRegion
from sim.numerics.elementary import wrap_angle
from sim.robot.costmap.costs import FREE, INSCRIBED, LETHAL, UNKNOWN
from sim.robot.costmap.robot_costmap import RobotCostmap
from sim.robot.costmap.view import CostmapName
from thbridge.ros.clients import FARTHEST, InvalidMessage
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import MAP_FRAME
from thbridge.ros2.action_messages import pose_stamped_of
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import StampedPoseFields
from thbridge.ros2.navigate_to_pose import planar_pose_of

CLEAR_ENTIRELY = "nav2_msgs/srv/ClearEntireCostmap"
CLEAR_AROUND_POSE = "nav2_msgs/srv/ClearCostmapAroundPose"
CLEAR_EXCEPT = "nav2_msgs/srv/ClearCostmapExceptRegion"
CLEARING: Mapping[str, str] = {
    "clear_entirely": CLEAR_ENTIRELY,
    "clear_around": "nav2_msgs/srv/ClearCostmapAroundRobot",
    "clear_around_pose": CLEAR_AROUND_POSE,
    "clear_except": CLEAR_EXCEPT,
}
"""Types of the services that clear a costmap, by the beginning of their names."""
GET_COSTMAP = "nav2_msgs/srv/GetCostmap"
GET_COST = "nav2_msgs/srv/GetCost"
GET_COSTS = "nav2_msgs/srv/GetCosts"
IS_PATH_VALID = "nav2_msgs/srv/IsPathValid"

Look = Callable[[], RobotCostmap]
"""Function that returns the present costmap."""

_OUTSIDE = -1
"""Cost of a point outside the costmap in responses of GetCost."""


class _Region(Protocol):
    reset_distance: float
    pose: StampedPoseFields


class _Point(Protocol):
    use_footprint: bool
    x: float
    y: float
    theta: float


class _Poses(Protocol):
    use_footprint: bool
    poses: Sequence[StampedPoseFields]


class _Path(Protocol):
    poses: Sequence[StampedPoseFields]


class _PathRequest(Protocol):
    path: _Path


def region_of(
    types: Distribution, service: str, robot: int, costmap: CostmapName, data: bytes
) -> ClearCostmapRegion | InvalidMessage:
    """Return the input that a request to clear a costmap asks for.

    Args:
        types: types of the messages.
        service: type of the service, one of `CLEARING`.
        robot: index of the robot in the team.
        costmap: name of the costmap.
        data: the request.
    """
    request = types.decode(f"{service}_Request", data)
    if service == CLEAR_ENTIRELY:
        return ClearCostmapRegion(robot, costmap)
    asked = cast(_Region, request)
    side = float(asked.reset_distance)
    if not abs(side) <= FARTHEST:
        return InvalidMessage("its distance is not a number, or longer than any map")
    middle = planar_pose_of(asked.pose) if service == CLEAR_AROUND_POSE else None
    if isinstance(middle, InvalidMessage):
        return middle
    return ClearCostmapRegion(robot, costmap, side, middle, service == CLEAR_EXCEPT)


def costmap_answer(types: Distribution, look: Look) -> Callable[[bytes], bytes]:
    """Return a function that answers requests for a costmap."""
    name = f"{GET_COSTMAP}_Response"

    def answer(request: bytes) -> bytes:
        types.decode(f"{GET_COSTMAP}_Request", request)
        now = look()
        rows, cols = now.costs.shape
        corner = cast(StampedPoseFields, pose_stamped_of(types, MAP_FRAME, stamp_ns(now.tick), now.origin))
        metadata = types.make(
            "nav2_msgs/msg/CostmapMetaData",
            map_load_time=corner.header.stamp,
            update_time=corner.header.stamp,
            layer="master",
            resolution=now.resolution,
            size_x=cols,
            size_y=rows,
            origin=corner.pose,
        )
        costs = now.costs.ravel()
        costmap = types.make("nav2_msgs/msg/Costmap", header=corner.header, metadata=metadata, data=costs)
        return types.encoded(name, map=costmap)

    return answer


def cost_answer(types: Distribution, look: Look) -> tuple[str, Callable[[bytes], bytes]]:
    """Return the type of the service `get_cost_*`, which is different in each distribution, and its answer."""
    if types.knows(GET_COSTS):
        return GET_COSTS, lambda data: _costs_of_poses(types, look, data)
    return GET_COST, lambda data: _cost_of_point(types, look, data)


def _cost_of_point(types: Distribution, look: Look, data: bytes) -> bytes:
    asked = cast(_Point, types.decode(f"{GET_COST}_Request", data))
    cost: int | None = None
    if all(abs(number) <= FARTHEST for number in (asked.x, asked.y, asked.theta)):
        pose = Pose2(asked.x, asked.y, wrap_angle(asked.theta))
        cost = look().footprint_cost(pose) if asked.use_footprint else look().cost_at(pose)
    name = f"{GET_COST}_Response"
    return types.encoded(name, cost=float(_OUTSIDE if cost is None else cost))


def _costs_of_poses(types: Distribution, look: Look, data: bytes) -> bytes:
    asked = cast(_Poses, types.decode(f"{GET_COSTS}_Request", data))
    now, costs, success = look(), list[int](), True
    for each in asked.poses:
        pose = planar_pose_of(each)
        if isinstance(pose, InvalidMessage):
            costs.append(UNKNOWN)
            success = False
        elif asked.use_footprint:
            costs.append(now.footprint_cost(pose))
        else:
            cost = now.cost_at(pose)
            costs.append(LETHAL if cost is None else cost)
            success = success and cost is not None
    name = f"{GET_COSTS}_Response"
    return types.encoded(name, costs=costs, success=success)


def path_answer(types: Distribution, look: Look) -> Callable[[bytes], bytes]:
    """Return a function that answers whether a path is free of obstacles, from the pose that is nearest to the robot.

    The functions' `look` returns the global costmap.
    """
    name = f"{IS_PATH_VALID}_Response"

    def answer(data: bytes) -> bytes:
        asked = types.decode(f"{IS_PATH_VALID}_Request", data)
        most = getattr(asked, "max_cost", LETHAL)  # Only Kilted has these two fields.
        unknown = LETHAL if getattr(asked, "consider_unknown_as_obstacle", False) else FREE
        valid = _is_free(look(), cast(_PathRequest, asked).path.poses, most, unknown)
        return types.encoded(name, is_valid=valid)

    return answer


def _is_free(costmap: RobotCostmap, path: Sequence[StampedPoseFields], most: int, unknown: int) -> bool:
    """Return True if the costs along the rest of a path are below `most`, and below LETHAL."""
    base, distances = costmap.base_in_map, list[float]()
    for each in path:
        x, y = each.pose.position.x - base.x, each.pose.position.y - base.y
        distances.append(x * x + y * y)
    nearest = min(range(len(path)), key=distances.__getitem__, default=0)
    if costmap.circular:
        most = min(most, INSCRIBED)
    for each in path[nearest:]:
        pose = planar_pose_of(each)
        if isinstance(pose, InvalidMessage):
            return False
        cost = costmap.cost_at(pose) if costmap.circular else costmap.footprint_cost(pose)
        cost = LETHAL if cost is None else unknown if cost == UNKNOWN else cost
        if cost >= min(most, LETHAL):
            return False
    return bool(path)
