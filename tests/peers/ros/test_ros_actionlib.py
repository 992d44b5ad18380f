"""Our account of goals beside the one that ROS's own actionlib keeps, request by request."""

import json
import os
import random
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL
from sim.inputs import SendGoal
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.navigation import Navigation
from tests.support.programs.peer_programs import run_peer
from thbridge.ros.actionlib import STATUS_PERIOD, ActionRequest, GoalEnded, MoveBaseServer, StatusList
from thbridge.ros.messages.records import CancelRequest, GoalRequest
from thbridge.ros.messages.stamps import stamp_ns

PYTHON = "/usr/bin/python3"
needs_actionlib = pytest.mark.skipif(
    not Path("/usr/lib/python3/dist-packages/actionlib").exists(), reason="python3-actionlib is not installed"
)

ROS_SIDE = """
import json, sys
import rospy
from actionlib_msgs.msg import GoalID
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal

now, said = [0], []

class Topic:
    def __init__(self, name, *args, **options):
        self.name = name.rpartition("/")[2]
    def publish(self, message):
        if self.name == "status":
            said.append(["status", [[s.goal_id.id, s.status] for s in message.status_list]])
        elif self.name == "result":
            said.append(["result", message.status.goal_id.id, message.status.status])

rospy.Publisher = rospy.Subscriber = Topic
rospy.Timer = lambda *args: None
rospy.get_param = lambda name, default=None: default
rospy.has_param = lambda name: False
rospy.search_param = lambda name: None
rospy.remap_name = lambda name: name
rospy.is_shutdown = lambda: False
rospy.Time.now = classmethod(lambda cls: rospy.Time(*divmod(now[0], 10**9)))

from actionlib import SimpleActionServer

server = SimpleActionServer("move_base", MoveBaseAction, auto_start=False)
server.start()
said.clear()
answers = []
for step in json.load(sys.stdin):
    now[0] = step["now"]
    for name, goal_id, stamp in step["requests"]:
        named = GoalID(rospy.Time(*divmod(stamp, 10**9)), goal_id)
        if name == "goal":
            server.action_server.internal_goal_callback(MoveBaseActionGoal(goal_id=named))
        else:
            server.action_server.internal_cancel_callback(named)
    # The loop of move_base.
    if server.is_new_goal_available():
        server.accept_new_goal()
    if server.is_active() and server.is_preempt_requested():
        server.set_preempted()
    if server.is_active() and step["end"] == "arrived":
        server.set_succeeded()
    if server.is_active() and step["end"] == "aborted":
        server.set_aborted()
    if step["periodic"]:
        server.action_server.publish_status()
    answers.append(list(said))
    said.clear()
json.dump(answers, sys.stdout)
"""

Step = dict[str, object]


def script(seed: int, steps: int, early_cancels: bool) -> list[Step]:
    """What clients and the robot do, every 100 ms.

    Only fresh goals are taken back by name: actionlib's Python server forgets one that it does not list after five
    seconds whatever else is taken back meanwhile, its C++ server (move_base's, and ours) keeps it longer.
    """
    chance = random.Random(seed)
    ids, told = count(), []
    known: list[str] = []
    born: dict[str, int] = {}
    for number in range(steps):
        tick = 5 * number
        now = stamp_ns(tick)
        requests: list[tuple[str, str, int]] = []
        while chance.random() < 0.25:
            kind = chance.choice(["goal", "goal", "goal", "again", "cancel", "before", "all", "early"])
            # Clients' clocks lag behind by up to a second.
            stamp = now - chance.randrange(1, 10**9) if chance.random() < 0.3 else now
            if kind == "goal":
                known.append(f"goal-{next(ids)}")
                born[known[-1]] = number
                requests.append(("goal", known[-1], stamp))
            elif kind == "again" and len(known) > 3:
                requests.append(("goal", chance.choice(known[:-3]), stamp))
            elif kind == "cancel" and known and number - born.get(known[-1], number) < 40:
                requests.append(("cancel", known[-1], 0))
            elif kind == "before":
                requests.append(("cancel", "", now - chance.randrange(1, 10**9)))
            elif kind == "all":
                requests.append(("cancel", "", 0))
            elif kind == "early" and early_cancels:
                known.append(f"goal-{next(ids)}")
                requests.append(("cancel", known[-1], 0))
        end = chance.choice(["arrived", "aborted"]) if chance.random() < 0.1 else ""
        periodic = tick % STATUS_PERIOD == 0
        told.append({"now": now, "tick": tick, "requests": requests, "end": end, "periodic": periodic})
    return told


def theirs(steps: list[Step]) -> list[list[list[object]]]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL"))}
    done = run_peer([PYTHON, "-c", ROS_SIDE], input=json.dumps(steps), env=environment)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def ours(steps: list[Step]) -> list[list[list[object]]]:
    server, answers, numbers = MoveBaseServer(0), [], count()
    goal: Goal | None = None
    results: list[GoalResult] = []
    none = np.empty((0, 3))
    for step in steps:
        requests: list[ActionRequest] = [
            GoalRequest(0, name, stamp, Pose2(0.0, 0.0, 0.0), next(numbers))
            if kind == "goal"
            else CancelRequest(0, name, stamp)
            for kind, name, stamp in step["requests"]
        ]
        for told in server.take(step["tick"], requests):
            if goal is not None:
                results.append(Cancelled(goal))
            goal = told.goal if isinstance(told, SendGoal) else None
        if goal is not None and step["end"]:
            # Before what may still wait to be told of earlier goals.
            results.insert(0, GoalReached(goal) if step["end"] == "arrived" else NoPath(goal, "stuck", "stuck"))
            goal = None
        result = results.pop(0) if results else None
        navigation = Navigation(STANDSTILL, goal, "idle", none, np.empty(0), none, result, 0.0)
        said = server.follow(step["tick"], navigation)
        told_all: list[list[object]] = []
        for item in said:
            if isinstance(item, StatusList):
                told_all.append(["status", [[entry.goal.id, int(entry.status)] for entry in item.entries]])
            elif isinstance(item, GoalEnded):
                told_all.append(["result", item.entry.goal.id, int(item.entry.status)])
        answers.append(told_all)
    return answers


@needs_actionlib
@pytest.mark.parametrize(("seed", "steps", "early"), [(seed, 45, True) for seed in range(8)] + [(9, 2000, False)])
def test_goals_stand_as_in_actionlib(seed: int, steps: int, early: bool) -> None:
    steps_done = script(seed, steps, early)
    found, expected = ours(steps_done), theirs(steps_done)
    for number, (step, our, their) in enumerate(zip(steps_done, found, expected, strict=True)):
        assert our == their, f"step {number}: {step}"
