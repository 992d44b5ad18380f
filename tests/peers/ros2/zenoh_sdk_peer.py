"""A node of zenoh-ros2-sdk: `zenoh_sdk_peer.py PORT DOMAIN`."""

import sys

import zenoh_ros2_sdk as sdk
from peer_commands import obey, tell
from zenoh_ros2_sdk.qos import QosDurability, QosProfile

port, domain = int(sys.argv[1]), int(sys.argv[2])
# Definitions are given, because the library would otherwise fetch them from the network.
text = {"msg_type": "std_msgs/msg/String", "msg_definition": "string data"}
service = {
    "srv_type": "std_srvs/srv/SetBool",
    "request_definition": "bool data",
    "response_definition": "bool success\nstring message",
}
here = {"node_name": "peer", "domain_id": domain, "router_port": port}
publishers, clients, kept = {}, {}, []


def do(command: dict) -> None:
    name = command.get("name", "")
    match command["do"]:
        case "subscribe":
            qos = QosProfile(durability=QosDurability.TRANSIENT_LOCAL) if command["latched"] else None
            take = lambda message: tell("message", name=name, text=message.data)  # noqa: E731
            kept.append(sdk.ROS2Subscriber(name, callback=take, qos=qos, **text, **here))
        case "publish":
            publishers[name] = publishers.get(name) or sdk.ROS2Publisher(name, **text, **here)
            publishers[name].publish(data=command["text"])
        case "serve":

            def answer(request: object) -> object:
                response = kept[0].session_mgr.store.types[kept[0].response_store_type]
                return response(success=request.data, message="by the sdk")

            kept.insert(0, sdk.ROS2ServiceServer(name, callback=answer, **service, **here))
        case "call":
            clients[name] = clients.get(name) or sdk.ROS2ServiceClient(name, **service, **here)
            response = clients[name].call(data=command["data"])
            tell("response", success=response.success, message=response.message)
        case "info":
            found = sdk.get_topic_info(name, domain_id=domain, router_port=port, timeout=1.0, verbose=True)
            told = [] if found is None else [*found.publishers, *found.subscribers]
            tell("info", types=sorted({each.topic_type for each in told}), nodes=[each.node_name for each in told])


obey(do)
