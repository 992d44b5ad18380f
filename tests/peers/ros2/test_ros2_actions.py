"""Actions over DDS: rclpy's client at our server, and our client at rclpy's server."""

import asyncio
import json
import uuid
from typing import Any

import pytest

from tests.peers.ros2.action_scripts import CLIENT, NEEDS_RCLPY, SERVER, running, steps
from tests.peers.ros2.peer_process import PYTHON, environment
from tests.support.programs.event_loops import eventually
from tests.support.programs.ports import free_domain
from tests.support.ros2.counting import FIBONACCI, CountingLogic, counting_types
from thbridge.ros2.actions import ActionGoalState, ActionGoalStatus, ActionResult, CancelAnswer, CancelCode, GoalInfo
from thbridge.ros2graph.sockets.action_client import GraphActionClient
from thbridge.ros2graph.sockets.action_server import GraphActionServer
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import NodeName

pytestmark = [NEEDS_RCLPY, pytest.mark.slow]
NAME = "/robot1/count"
DOMAIN = free_domain()
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6


def test_a_client_of_rclpy_sends_cancels_and_preempts() -> None:
    async def whole() -> str:
        with counting_types() as types:
            carrier, logic = DdsCarrier(DOMAIN), CountingLogic(types)
            node = NodeName("/robot1", "counter")
            carrier.add_node(node)
            server = GraphActionServer(carrier, node, NAME, types, FIBONACCI, logic)
            assert await carrier.start() is None

            async def count() -> None:
                while True:
                    logic.step()
                    server.publish()
                    await asyncio.sleep(0.02)

            counting = asyncio.create_task(count())
            arguments = ["-c", CLIENT, NAME, FIBONACCI, json.dumps({"order": 5}), json.dumps({"order": 100_000})]
            client = await asyncio.create_subprocess_exec(
                PYTHON, *arguments, env=environment(DOMAIN), stdout=asyncio.subprocess.PIPE
            )
            output, _ = await asyncio.wait_for(client.communicate(), 120.0)
            counting.cancel()
            await carrier.stop()
            assert client.returncode == 0, output
            return output.decode()

    found = steps(asyncio.run(whole()))
    assert found["succeeds"] == {"accepted": True, "feedback": True, "status": SUCCEEDED, "ids": True}
    assert found["repeated"] == {"accepted": False}
    assert found["canceled"] == {"accepted": True, "code": 0, "goals": 1, "status": CANCELED}
    assert found["too late"] == {"code": 3, "goals": 0}
    assert found["preempted"] == {"ends": [ABORTED, SUCCEEDED]}
    assert found["unknown"] == {"status": 0}
    assert found["listed"] == {"last": [SUCCEEDED, CANCELED, ABORTED, SUCCEEDED]}


def test_our_client_at_a_server_of_rclpy() -> None:
    async def whole() -> None:
        with counting_types() as types, running(SERVER, DOMAIN, NAME, FIBONACCI):
            carrier, node = DdsCarrier(DOMAIN), NodeName("/", "operator")
            carrier.add_node(node)
            feedback: list[tuple[bytes, Any]] = []
            statuses: list[tuple[ActionGoalStatus, ...]] = []
            client = GraphActionClient(
                carrier, node, NAME, types, FIBONACCI, lambda *each: feedback.append(each), statuses.append
            )
            assert await carrier.start() is None
            results: dict[bytes, ActionResult[Any]] = {}
            answers: list[int | None] = []

            async def send(order: int) -> bytes:
                goal_id, before = uuid.uuid4().bytes, len(answers)
                client.send_goal(goal_id, types.make(f"{FIBONACCI}_Goal", order=order), answers.append)
                await eventually(lambda: len(answers) > before)
                client.get_result(goal_id, lambda result: results.__setitem__(goal_id, result))
                return goal_id

            async with asyncio.timeout(120.0):
                await eventually(lambda: client.has_server)
                counted = await send(5)
                assert answers[-1] is not None
                await eventually(lambda: counted in results)
                state, value = results[counted]
                assert (state, [*value.sequence]) == (ActionGoalState.SUCCEEDED, [0, 1, 2, 3, 4])
                assert {goal_id for goal_id, _ in feedback} == {counted}
                rejected = await send(-1)
                assert answers[-1] is None
                await eventually(lambda: rejected in results)
                assert results[rejected].state is ActionGoalState.UNKNOWN
                canceled = await send(100_000)
                canceling: list[CancelAnswer] = []
                client.cancel(GoalInfo(canceled, 0), canceling.append)
                await eventually(lambda: canceled in results)
                assert results[canceled].state is ActionGoalState.CANCELED
                assert [(answer.code, [goal.id for goal in answer.goals]) for answer in canceling] == [
                    (CancelCode.NONE, [canceled])
                ]
                await eventually(
                    lambda: (
                        [state for _, state in statuses[-1]] == [ActionGoalState.SUCCEEDED, ActionGoalState.CANCELED]
                    )
                )
            await carrier.stop()

    asyncio.run(whole())
