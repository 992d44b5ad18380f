"""Our master and the real rosmaster give the same replies and notifications to the same calls."""

import json
import random
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from thbridge.rosgraph.wire.master import METHODS, Master, NodeShutdown, Notification, ParamUpdate, PublisherUpdate
from thbridge.rosgraph.wire.xmlrpc import MethodCall, XmlRpcValue

PYTHON = "/usr/bin/python3"
SEQUENCES = 150
CALLS = 80

pytestmark = pytest.mark.skipif(
    not Path("/usr/lib/python3/dist-packages/rosmaster").is_dir(), reason="no ROS 1: rosmaster is not installed"
)

NODES = ["/a", "/b", "/ns/a", "/ns/deep/c", "/"]
URIS = ["http://h:1/", "http://h:2/", "http://h:3/", "rosrpc://h:4", "ftp://h", "", 5]
TOPICS = ["/t", "t", "/ns/t", "ns/t", "~t", "//t/", "/", "", "a b", "http://t", 3, None]
TYPES = ["std_msgs/String", "a/B", "*", "String", "a/b/c", "", 7]
KEYS = ["/p", "p", "p/q", "/p/q/r", "~p", "/ns/p", "//p//q/", "/", "~", "q", "ns", "", 0, ["p"], 2.5]
SUBGRAPHS = ["", "/", "/ns", "ns/", "t", "~", 1]
VALUES: list[XmlRpcValue] = [
    1,
    0,
    "text",
    "",
    2.5,
    True,
    [1, [2]],
    {},
    {"q": 1},
    {"q": {"r": 2}, "x/y": 3},
    {"q": None},
    None,
]
SIGNATURES = {
    "registerPublisher": (TOPICS, TYPES, URIS),
    "unregisterPublisher": (TOPICS, URIS),
    "registerSubscriber": (TOPICS, TYPES, URIS),
    "unregisterSubscriber": (TOPICS, URIS),
    "registerService": (TOPICS, URIS, URIS),
    "unregisterService": (TOPICS, URIS),
    "lookupService": (TOPICS,),
    "lookupNode": ([*NODES, *TOPICS],),
    "getPublishedTopics": (SUBGRAPHS,),
    "getTopicTypes": (),
    "getSystemState": (),
    "getUri": (),
    "shutdown": (["over"],),
    "setParam": (KEYS, VALUES),
    "getParam": (KEYS,),
    "deleteParam": (KEYS,),
    "hasParam": (KEYS,),
    "searchParam": (KEYS,),
    "subscribeParam": (URIS, KEYS),
    "unsubscribeParam": (URIS, KEYS),
    "getParamNames": (),
}


class Oracle:
    def __init__(self) -> None:
        script = Path(__file__).with_name("rosmaster_oracle.py")
        self._process = subprocess.Popen(
            [PYTHON, "-E", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )

    def ask(self, question: list[object]) -> object:
        self._process.stdin.write(json.dumps(question) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        self._process.communicate()


@pytest.fixture(scope="module")
def oracle() -> Iterator[Oracle]:
    asked = Oracle()
    yield asked
    asked.close()


def pick(draw: random.Random, choices: list[object]) -> object:
    """Mostly of the valid first ones, so that calls have to do with each other."""
    return draw.choice(choices[:4] if draw.random() < 0.8 else choices)


def random_call(draw: random.Random) -> tuple[str, list[object]]:
    method = draw.choice([*SIGNATURES])
    arguments = [pick(draw, [*choices]) for choices in SIGNATURES[method]]
    if draw.random() < 0.02:
        arguments = arguments[:-1] if arguments and draw.random() < 0.5 else [*arguments, "one more"]
        return method, [draw.choice(NODES), *arguments]
    if draw.random() < 0.02:
        return method, draw.choice([[], [5, *arguments], [None, *arguments]])
    return method, [draw.choice(NODES), *arguments]


def shown(notification: Notification) -> list[object]:
    match notification:
        case PublisherUpdate(api, topic, publishers):
            return ["PublisherUpdate", api, topic, [*publishers]]
        case ParamUpdate(api, key, value):
            return ["ParamUpdate", api, key, value]
        case NodeShutdown(api, node, reason):
            return ["Shutdown", api, node, reason]


def test_every_method_is_compared():
    assert {*SIGNATURES} == METHODS - {"getPid"}


@pytest.mark.parametrize("block", range(5))
def test_same_calls_same_replies(oracle, block):
    for seed in range(block * SEQUENCES // 5, (block + 1) * SEQUENCES // 5):
        draw = random.Random(seed)
        oracle.ask([])
        ours = Master("http://master:11311/", 1)
        # rosmaster words a refusal otherwise until somebody has offered a service
        calls = [("registerService", ["/a", "/s", "rosrpc://h:9", "http://h:1/"])]
        calls += [random_call(draw) for _ in range(CALLS)]
        for method, params in calls:
            (status, message, value), told = oracle.ask([method, params])
            reply, notifications = ours.handle(MethodCall(method, json.loads(json.dumps(params))))
            context = f"sequence {seed}: {method}{params}"
            assert (reply.status, reply.value) == (status, value), context
            assert type(reply.value) is type(value), context
            assert [shown(notification) for notification in notifications] == told, context
            if not message.startswith("Error: invalid arguments"):  # then it is Python's own words
                assert reply.message == message, context
