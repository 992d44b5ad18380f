"""Ask a node of rclpy for the descriptions of message and service types; print names and encodings of their sources.

Arguments are names with hashes, in turn.
"""

import json
import sys
from importlib import import_module

import rclpy
from rclpy.executors import SingleThreadedExecutor
from type_description_interfaces.srv import GetTypeDescription

rclpy.init()
executor = SingleThreadedExecutor()
server, asking = rclpy.create_node("server"), rclpy.create_node("asking")
executor.add_node(server)
executor.add_node(asking)
client = asking.create_client(GetTypeDescription, "/server/get_type_description")
kept = []
for name, type_hash in zip(sys.argv[1::2], sys.argv[2::2], strict=True):
    package, kind, word = name.split("/")
    used = getattr(import_module(f"{package}.{kind}"), word)
    if kind == "msg":
        kept.append(server.create_publisher(used, word, 1))
    else:
        kept.append(server.create_service(used, word, lambda _, response: response))
    while not client.service_is_ready():
        executor.spin_once(timeout_sec=0.1)
    answer = client.call_async(GetTypeDescription.Request(type_name=name, type_hash=type_hash))
    executor.spin_until_future_complete(answer)
    print(json.dumps([[source.type_name, source.encoding] for source in answer.result().type_sources]), flush=True)
