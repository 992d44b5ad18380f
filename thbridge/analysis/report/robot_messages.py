"""Poses, batteries and goals of robots, read message by message; `MessageBatches` reads more frequent types."""

import math
from collections.abc import Callable

from thbridge.analysis.report.report import GoalAttempt
from thbridge.analysis.report.tracks import SeriesByTopic, deviations
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.goal_status import GoalStatusCode
from thbridge.ros.messages.plausible import is_plausible
from thbridge.ros.messages.unpack import PoseInFrame

OUTCOMES: dict[int, str] = {
    GoalStatusCode.SUCCEEDED: "arrived",
    GoalStatusCode.ABORTED: "no path",
    GoalStatusCode.PREEMPTED: "cancelled",
}


class RobotMessages:
    """Converter of messages about robots into series.

    Args:
        series: receives the data.
        seconds: function that converts a stamp in nanoseconds to seconds of the report.

    Attributes:
        handlers: functions by message type, which receive time, topic and bytes of a message, and raise ValueError if
            the message cannot be read.
    """

    def __init__(self, series: SeriesByTopic, seconds: Callable[[int], float]) -> None:
        self._series, self._seconds = series, seconds
        self.handlers: dict[str, Callable[[float, str, bytes], None]] = {
            types.POSE_WITH_COVARIANCE: self._pose_with_covariance,
            types.POSE_STAMPED: self._pose,
            types.BATTERY_STATE: self._battery,
            types.MOVE_BASE_GOAL: self._goal,
            types.MOVE_BASE_RESULT: self._result,
            types.DIAGNOSTIC_ARRAY: self._diagnoses,
        }

    def _pose_with_covariance(self, time: float, topic: str, data: bytes) -> None:
        self._add_pose(time, topic, unpack.pose_with_covariance(data))

    def _pose(self, time: float, topic: str, data: bytes) -> None:
        self._add_pose(time, topic, unpack.pose_stamped(data))

    def _add_pose(self, time: float, topic: str, message: PoseInFrame) -> None:
        poses = self._series.poses.get(topic)
        if poses is None:
            poses = self._series.poses[topic] = self._series.poses_of(message.frame, "")
        pose = message.pose
        if not is_plausible(pose.x, pose.y, pose.theta):
            self._series.left_out[topic] += 1
            return
        stamp = self._seconds(message.stamp_ns) if message.stamp_ns else math.nan
        poses.add(time, stamp, pose)
        if (row := deviations(time, message.covariance)) is not None:
            _, position, heading = row
            poses.deviations.extend((time, stamp, position, heading))

    def _battery(self, time: float, topic: str, data: bytes) -> None:
        message = unpack.battery_state(data)
        left = message.charge if math.isfinite(message.charge) else 100.0 * message.percentage
        if is_plausible(left):
            self._series.energy[topic].extend((time, left))

    def _goal(self, time: float, topic: str, data: bytes) -> None:
        self._series.goals[_action(topic)][unpack.move_base_goal(data).goal_id] = time

    def _result(self, time: float, topic: str, data: bytes) -> None:
        message = unpack.move_base_result(data)
        start = self._series.goals[_action(topic)].pop(message.goal_id, None)
        if start is not None:
            outcome = OUTCOMES.get(message.status, f"status {message.status}")
            self._series.attempts[_action(topic)].append(GoalAttempt(start, time, outcome, message.text))

    def _diagnoses(self, time: float, topic: str, data: bytes) -> None:
        self._series.ways_made.take(time, unpack.diagnostic_array(data))


def _action(topic: str) -> str:
    """Return the name of the action that a topic of goals or results belongs to, with a slash at the end."""
    return topic.rpartition("/")[0] + "/"
