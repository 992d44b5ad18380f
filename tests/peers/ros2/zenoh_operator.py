"""A node of this project over zenoh, in its own process, which can be killed: `zenoh_operator.py ROUTER DOMAIN`.

It sends a goal to a robot, or subscribes to all topics of the graph and counts their messages.
"""

import asyncio
import sys
from collections import Counter

from peer_commands import obey, tell

from tests.support.ros2.navigation_goals import goal_id, navigation_goal
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE
from thbridge.ros2.supports import MessageSupport
from thbridge.ros2graph.sockets.action_client import GraphActionClient
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.sockets.addresses import parse_address

domain = int(sys.argv[2])
node, kilted = NodeName("/", "killed"), Distribution.of("kilted")


async def main() -> None:
    loop = asyncio.get_running_loop()
    carrier = ZenohCarrier(domain, parse_address(sys.argv[1]))
    client = GraphActionClient(carrier, node, "/robot1/navigate_to_pose", kilted, NAVIGATE_TO_POSE)
    assert await carrier.start() is None
    counts = Counter[str]()

    async def do(command: dict) -> None:
        while not client.has_server:
            await asyncio.sleep(0.01)
        if command["do"] == "goal":
            goal, uuid = navigation_goal(kilted, command["x"]), goal_id(command["id"])

            def answered(accepted: int | None) -> None:
                tell("answer", accepted=accepted)
                client.get_result(uuid, lambda result: tell("result", status=result.state.name))

            client.send_goal(uuid, goal, answered)
            return
        if command["do"] == "subscribe":
            for (name, role), each in {(each.name, each.role): each for each in carrier.endpoints()}.items():
                if role is EndpointRole.PUBLISHER:
                    support = MessageSupport(each.type, each.hash)
                    carrier.subscribe(node, name, support, each.qos, lambda *item, name=name: counts.update([name]))
        tell("counts", **{name.lstrip("/"): number for name, number in counts.items()})

    await asyncio.to_thread(obey, lambda command: asyncio.run_coroutine_threadsafe(do(command), loop).result())


asyncio.run(main())
