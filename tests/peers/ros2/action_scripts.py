"""Programs of rclpy: a client and a server of actions. They run in the peer's own Python and print lines of JSON."""

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from tests.peers.ros2.peer_process import PYTHON, environment

NEEDS_RCLPY = pytest.mark.skipif(
    not PYTHON.exists(), reason="rclpy is not installed in .peers/ros2 (see scripts/install_peers.sh)"
)

CLIENT = """
import importlib, json, sys, uuid
import rclpy
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from unique_identifier_msgs.msg import UUID

name, kind, first, second = sys.argv[1:5]
package, _, word = kind.split("/")
Type = getattr(importlib.import_module(f"{package}.action"), word)
rclpy.init()
node = rclpy.create_node("operator")
executor = SingleThreadedExecutor()
executor.add_node(node)
client = ActionClient(node, Type, name)

def wait(future, seconds=30.0):
    executor.spin_until_future_complete(future, seconds)
    assert future.done(), "no answer"
    return future.result()

def show(**fields):
    print(json.dumps(fields), flush=True)

def goal_of(text):
    def fill(message, fields):
        for field, value in fields.items():
            if isinstance(value, dict):
                fill(getattr(message, field), value)
            else:
                setattr(message, field, value)
        return message
    return fill(Type.Goal(), json.loads(text))

assert client.wait_for_server(30.0), "no server"
statuses = []
from action_msgs.msg import GoalStatusArray
from rclpy.qos import qos_profile_action_status_default
node.create_subscription(
    GoalStatusArray, f"{name}/_action/status",
    lambda message: statuses.append([s.status for s in message.status_list]), qos_profile_action_status_default)

# A goal that succeeds.
feedback = []
chosen = UUID(uuid=list(range(16)))
handle = wait(client.send_goal_async(goal_of(first), feedback.append, chosen))
result = wait(handle.get_result_async())
show(step="succeeds", accepted=handle.accepted, feedback=len(feedback) > 0, status=result.status,
     ids=all(bytes(each.goal_id.uuid) == bytes(range(16)) for each in feedback))

# The same id again; rclpy's client keeps no goal of this id.
again = wait(client.send_goal_async(goal_of(first), None, chosen))
show(step="repeated", accepted=again.accepted)

# A goal that is canceled.
handle = wait(client.send_goal_async(goal_of(second)))
answer = wait(handle.cancel_goal_async())
result = wait(handle.get_result_async())
show(step="canceled", accepted=handle.accepted, code=answer.return_code, goals=len(answer.goals_canceling),
     status=result.status)
answer = wait(handle.cancel_goal_async())
show(step="too late", code=answer.return_code, goals=len(answer.goals_canceling))

# Two goals: the second preempts the first.
old = wait(client.send_goal_async(goal_of(second)))
new = wait(client.send_goal_async(goal_of(first)))
ends = [wait(each.get_result_async()).status for each in (old, new)]
show(step="preempted", ends=ends)

# An unknown goal.
service = node.create_client(Type.Impl.GetResultService, f"{name}/_action/get_result")
assert service.wait_for_service(30.0)
answer = wait(service.call_async(Type.Impl.GetResultService.Request(goal_id=UUID(uuid=[9] * 16))))
show(step="unknown", status=answer.status)
executor.spin_once(0.5)
show(step="listed", last=statuses[-1])
"""

SERVER = """
import importlib, json, sys, threading, time
import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.callback_groups import ReentrantCallbackGroup

name, kind = sys.argv[1:3]
package, _, word = kind.split("/")
Type = getattr(importlib.import_module(f"{package}.action"), word)
rclpy.init()
node = rclpy.create_node("counter")

def execute(handle):
    for number in range(handle.request.order):
        if handle.is_cancel_requested:
            handle.canceled()
            return Type.Result(sequence=[-1])
        handle.publish_feedback(Type.Feedback(sequence=list(range(number + 1))))
        time.sleep(0.02)
    handle.succeed()
    return Type.Result(sequence=list(range(handle.request.order)))

server = ActionServer(
    node, Type, name, execute, callback_group=ReentrantCallbackGroup(),
    goal_callback=lambda goal: GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT,
    cancel_callback=lambda handle: CancelResponse.ACCEPT)
executor = MultiThreadedExecutor()
executor.add_node(node)
print(json.dumps({"step": "ready"}), flush=True)
executor.spin()
"""


@contextmanager
def running(script: str, domain: int, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Run a script, and end it at the end."""
    command = [PYTHON, "-c", script, *arguments]
    process = subprocess.Popen(command, env=environment(domain), stdout=subprocess.PIPE, text=True, stderr=sys.stderr)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def steps(output: str) -> dict[str, dict[str, object]]:
    """Return what a script printed, by step."""
    lines = [json.loads(line) for line in output.splitlines()]
    return {line.pop("step"): line for line in lines}
