"""The slave API: calls in, replies and consequences out."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.rosgraph.wire.slave import (
    METHODS,
    BusConnection,
    NodeDescription,
    ParameterChanged,
    PublishersChanged,
    ShutdownRequested,
    SlaveReply,
    answer_call,
)
from thbridge.rosgraph.wire.xmlrpc import MethodCall

NODE = NodeDescription(
    name="/us",
    uri="http://127.0.0.1:5000/",
    master_uri="http://127.0.0.1:11311",
    pid=4711,
    tcpros=("127.0.0.1", 6000),
    publications={"/chatter": "std_msgs/String"},
    subscriptions={"/tf": "tf2_msgs/TFMessage"},
    parameters=["/robot1/amcl/odom_alpha1", "/robot1/move_base"],
    connections=lambda: [
        BusConnection(1, "/rviz", True, "/chatter", (6000, "127.0.0.1", 40000, 9), 300, 3),
        BusConnection(2, "http://127.0.0.1:5001/", False, "/tf", (40001, "127.0.0.1", 6001, 10), 200, 2),
    ],
)


def asked(method: str, *params) -> SlaveReply:
    return answer_call(MethodCall(method, ["/them", *params]), NODE)


@pytest.mark.parametrize(
    ("method", "value"),
    [
        ("getPid", 4711),
        ("getName", "/us"),
        ("getUri", "http://127.0.0.1:5000/"),
        ("getMasterUri", "http://127.0.0.1:11311"),
        ("getPublications", [["/chatter", "std_msgs/String"]]),
        ("getSubscriptions", [["/tf", "tf2_msgs/TFMessage"]]),
        (
            "getBusStats",
            [[["/chatter", 300, [[1, 300, 3, True]]]], [["/tf", [[2, 200, 2, -1, True]]]], []],
        ),
        (
            "getBusInfo",
            [
                [
                    1,
                    "/rviz",
                    "o",
                    "TCPROS",
                    "/chatter",
                    True,
                    "TCPROS connection on port 6000 to [127.0.0.1:40000 on socket 9]",
                ],
                [
                    2,
                    "http://127.0.0.1:5001/",
                    "i",
                    "TCPROS",
                    "/tf",
                    True,
                    "TCPROS connection on port 40001 to [127.0.0.1:6001 on socket 10]",
                ],
            ],
        ),
    ],
)
def test_a_question_has_its_answer_and_no_consequence(method, value):
    code, _, told = asked(method).reply
    assert (code, told) == (1, value)
    assert asked(method).consequence is None


def test_a_subscriber_is_told_where_to_connect():
    reply = asked("requestTopic", "/chatter", [["UDPROS", b"", "host", 1, 2], ["TCPROS"]]).reply
    assert (reply[0], reply[2]) == (1, ["TCPROS", "127.0.0.1", 6000])


def test_udpros_is_refused_politely():
    code, message, value = asked("requestTopic", "/chatter", [["UDPROS", b"", "host", 1, 1500]]).reply
    assert (code, value) == (0, [])
    assert "TCPROS" in message


def test_nobody_is_connected_to_a_topic_that_is_not_published():
    code, _, value = asked("requestTopic", "/tf", [["TCPROS"]]).reply
    assert (code, value) == (-1, [])


def test_news_of_publishers_are_passed_on():
    told = asked("publisherUpdate", "/tf", ["http://a:1/", "http://b:2/"])
    assert told.consequence == PublishersChanged("/tf", ("http://a:1/", "http://b:2/"))
    assert told.reply[0] == 1


@pytest.mark.parametrize(
    ("key", "wanted"),
    [
        ("/robot1/amcl/odom_alpha1/", "/robot1/amcl/odom_alpha1"),
        ("/robot1/move_base/recovery_behaviors", "/robot1/move_base"),
    ],
)
def test_a_parameter_is_passed_on_to_who_wants_it_or_what_is_above_it(key, wanted):
    assert asked("paramUpdate", key, 0.5).consequence == ParameterChanged(key.rstrip("/"), 0.5, (wanted,))


@pytest.mark.parametrize("key", ["/robot1/amcl/odom_alpha10", "/robot1", "/robot1/move_base2"])
def test_another_parameter_is_not(key):
    assert asked("paramUpdate", key, 0.5).reply[0] == -1


def test_the_word_to_go_is_passed_on():
    assert asked("shutdown", "new node registered").consequence == ShutdownRequested("new node registered")


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text() | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=3),
)


@given(st.sampled_from(sorted(METHODS | {"system.exit"})), st.lists(values, max_size=4))
def test_no_arguments_make_it_raise_and_every_reply_is_one_of_ros(method, params):
    code, message, _ = answer_call(MethodCall(method, params), NODE).reply
    assert code in (-1, 0, 1)
    assert isinstance(message, str)
