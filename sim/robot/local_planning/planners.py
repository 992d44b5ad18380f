"""Choice of a robot's local planner."""

from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters
from sim.robot.local_planning.dwa import DwaPlanner
from sim.robot.local_planning.local_planner import LocalPlanner
from sim.robot.local_planning.trajectory_rollout import TrajectoryPlanner


def local_planner(
    parameters: RobotParameters, footprint: FloatArray, shape: tuple[int, int], period: float
) -> LocalPlanner:
    """Make the local planner that `move_base: base_local_planner` names.

    Args:
        parameters: parameters of the robot's software.
        footprint: (n, 2) padded corners, base frame.
        shape: rows and columns of the local costmap.
        period: time between two commands, seconds.
    """
    padding, inflation = parameters.local_costmap.footprint_padding, parameters.local_costmap.inflation_layer
    if parameters.move_base.base_local_planner == "dwa_local_planner/DWAPlannerROS":
        return DwaPlanner(parameters.DWAPlannerROS, footprint, inflation, shape, period, padding)
    return TrajectoryPlanner(parameters.TrajectoryPlannerROS, footprint, inflation, shape, period, padding)
