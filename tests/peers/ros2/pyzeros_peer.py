"""A node of pyzeros: `pyzeros_peer.py PORT DOMAIN`."""

import asyncio
import json
import sys

import pyzeros
import zenoh
from peer_commands import obey, tell
from ros2_pyterfaces.cyclone.all_msgs import String
from ros2_pyterfaces.cyclone.all_srvs import SetBool

port, domain = int(sys.argv[1]), int(sys.argv[2])
config = zenoh.Config()
for key, value in {
    "mode": "peer",
    "connect/endpoints": [f"tcp/127.0.0.1:{port}"],
    "listen/endpoints": ["tcp/127.0.0.1:0"],
    "scouting/multicast/enabled": False,
}.items():
    config.insert_json5(key, json.dumps(value))


async def main() -> None:
    publishers, clients, tasks = {}, {}, []
    loop = asyncio.get_running_loop()

    async def messages(name: str, subscription: pyzeros.Sub) -> None:
        async for message in subscription.listen_reliable():
            tell("message", name=name, text=message.data)

    async def requests(server: pyzeros.Server) -> None:
        async for each in server.listen_reliable():
            each.response.success, each.response.message = each.request.data, "by pyzeros"
            each.send()

    async def call(client: pyzeros.Client, data: bool) -> None:
        response = await client.call_async(SetBool.Request(data=data))
        tell("response", success=bool(response.success), message=response.message)

    def do(command: dict) -> None:
        name = command["name"]
        match command["do"]:
            case "subscribe":
                tasks.append(loop.create_task(messages(name, pyzeros.Sub(String, name, session=node))))
            case "publish":
                publishers[name] = publishers.get(name) or pyzeros.Pub(String, name, session=node)
                publishers[name].publish(String(data=command["text"]))
            case "serve":
                tasks.append(loop.create_task(requests(pyzeros.Server(SetBool, name, session=node))))
            case "call":
                clients[name] = clients.get(name) or pyzeros.Client(SetBool, name, session=node)
                tasks.append(loop.create_task(call(clients[name], command["data"])))

    with pyzeros.auto_context(node="peer", zenoh_session=zenoh.open(config), domain_id=domain) as node:
        await asyncio.to_thread(obey, lambda command: loop.call_soon_threadsafe(do, command))


asyncio.run(main())
