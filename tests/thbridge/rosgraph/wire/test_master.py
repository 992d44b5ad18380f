"""The master's state: replies, and who is told what. tests/peers compares it with rosmaster, call by call."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.rosgraph.wire import master as master_module
from thbridge.rosgraph.wire import registrations
from thbridge.rosgraph.wire.master import METHODS, ApiReply, Master, NodeShutdown, ParamUpdate, PublisherUpdate
from thbridge.rosgraph.wire.xmlrpc import MethodCall, XmlRpcValue, encode_response

TALKER, LISTENER, SECOND = "http://localhost:1/", "http://localhost:2/", "http://localhost:3/"
STRING = "std_msgs/String"


class Asked:
    def __init__(self) -> None:
        self.master = Master("http://localhost:11311/", 17)
        self.told: list[object] = []

    def __call__(self, method: str, *params: XmlRpcValue) -> ApiReply:
        reply, told = self.master.handle(MethodCall(method, [*params]))
        self.told = [*told]
        return reply

    def value(self, method: str, *params: XmlRpcValue) -> XmlRpcValue:
        reply = self(method, "/test", *params)
        assert reply.status == 1
        return reply.value


@pytest.fixture
def ask() -> Asked:
    return Asked()


def test_subscribers_are_told_who_publishes(ask):
    assert ask("registerSubscriber", "/listener", "/chat", STRING, LISTENER).value == []
    reply = ask("registerPublisher", "/talker", "/chat", STRING, TALKER)
    assert reply == ApiReply(1, "Registered [/talker] as publisher of [/chat]", [LISTENER])
    assert ask.told == [PublisherUpdate(LISTENER, "/chat", (TALKER,))]
    ask("registerPublisher", "/second", "/chat", STRING, SECOND)
    assert ask.told == [PublisherUpdate(LISTENER, "/chat", (TALKER, SECOND))]
    assert ask("unregisterPublisher", "/talker", "/chat", TALKER).value == 1
    assert ask.told == [PublisherUpdate(LISTENER, "/chat", (SECOND,))]
    assert ask("unregisterPublisher", "/talker", "/chat", TALKER).value == 0
    assert ask.told == []
    assert ask.value("getSystemState") == [[["/chat", ["/second"]]], [["/chat", ["/listener"]]], []]
    assert ask.value("getPublishedTopics", "") == [["/chat", STRING]]


def test_a_type_is_not_unlearned(ask):
    ask("registerSubscriber", "/listener", "/chat", "*", LISTENER)
    assert ask.value("getTopicTypes") == []
    ask("registerPublisher", "/talker", "/chat", "*", TALKER)
    assert ask.value("getTopicTypes") == [["/chat", "*"]]
    ask("registerPublisher", "/talker", "/chat", STRING, TALKER)
    ask("registerPublisher", "/second", "/chat", "*", SECOND)
    assert ask.value("getTopicTypes") == [["/chat", STRING]]


def test_a_node_of_the_same_name_takes_the_place_of_the_old_one(ask):
    ask("registerPublisher", "/node", "/chat", STRING, TALKER)
    ask("registerService", "/node", "/serve", "rosrpc://localhost:9", TALKER)
    ask("registerSubscriber", "/node", "/other", STRING, SECOND)
    assert ask.told == [NodeShutdown(TALKER, "/node", "new node registered with same name")]
    assert ask.value("getSystemState") == [[], [["/other", ["/node"]]], []]
    assert ask.value("lookupNode", "/node") == SECOND
    assert ask("unregisterPublisher", "/node", "/chat", TALKER).value == 0


def test_a_service_has_one_provider_the_last(ask):
    ask("registerService", "/first", "/serve", "rosrpc://localhost:8", TALKER)
    ask("registerService", "/second", "/serve", "rosrpc://localhost:9", SECOND)
    assert ask.value("lookupService", "/serve") == "rosrpc://localhost:9"
    assert ask("unregisterService", "/first", "/serve", "rosrpc://localhost:8").value == 0
    assert ask("unregisterService", "/second", "/serve", "rosrpc://localhost:9").value == 1
    assert ask("lookupService", "/test", "/serve") == ApiReply(-1, "no provider", "")


def test_a_node_is_known_while_it_is_registered_for_something(ask):
    ask("registerSubscriber", "/listener", "/chat", STRING, LISTENER)
    assert ask.value("lookupNode", "/listener") == LISTENER
    ask("unregisterSubscriber", "/listener", "/chat", LISTENER)
    assert ask("lookupNode", "/test", "/listener").status == -1


def test_parameters_and_their_subscribers(ask):
    assert ask.value("subscribeParam", LISTENER, "/robot/speed") == {}
    ask("setParam", "/other", "/robot", {"speed": 1.5, "name": "x"})
    assert ask.told == [ParamUpdate(LISTENER, "/robot/speed/", 1.5)]
    ask("setParam", "/test", "/robot/speed", 2.0)
    assert ask.told == []  # it set it itself
    ask("deleteParam", "/other", "/robot/speed")
    assert ask.told == [ParamUpdate(LISTENER, "/robot/speed/", {})]
    ask("unsubscribeParam", "/test", LISTENER, "/robot/speed")
    ask("setParam", "/other", "/robot/speed", 3.0)
    assert ask.told == []
    assert ask.value("getParam", "/robot") == {"name": "x", "speed": 3.0}
    assert ask("getParam", "/robot/x", "~speed").status == -1
    assert ask("getParam", "/robot", "~speed").value == 3.0


def test_who_refuses_updates_gets_no_more(ask):
    ask("subscribeParam", "/a", LISTENER, "/x")
    ask("subscribeParam", "/b", SECOND, "/x")
    ask.master.refuse_update(LISTENER, "/x/")
    ask("setParam", "/other", "/x", 1)
    assert ask.told == [ParamUpdate(SECOND, "/x/", 1)]


def test_about_itself(ask):
    assert ask.value("getUri") == "http://localhost:11311/"
    assert ask.value("getPid") == 17
    assert not ask.master.stopped
    assert ask("shutdown", "/test", "enough") == ApiReply(1, "shutdown", 0)
    assert ask.master.stopped


@pytest.mark.parametrize("method", sorted(METHODS))
def test_wrong_calls_are_refused_by_every_method(ask, method):
    assert ask(method).status == -1
    assert ask(method, 5).status == -1
    assert ask(method, "/test", 1, 2, 3, 4).status == -1


def test_what_is_too_deep_to_be_sent_is_refused(ask):
    refused = ask("setParam", "/test", "/a" * 200, 1)
    assert refused.status == -1 and "deep" in refused.message


def test_a_graph_of_a_thousand_nodes_and_five_thousand_topics_is_taken(ask):
    for node in range(1000):
        for topic in ("/rosout", *(f"/n{node}/t{number}" for number in range(5))):
            assert ask("registerPublisher", f"/n{node}", topic, STRING, f"http://h:{node}/").status == 1
        for topic in ("/clock", *(f"/n{node + 1}/t{number}" for number in range(5))):
            assert ask("registerSubscriber", f"/n{node}", topic, STRING, f"http://h:{node}/").status == 1
        assert ask("setParam", f"/n{node}", f"/n{node}/amcl", {f"p{number}": 1.0 for number in range(30)}).status == 1
    published, subscribed, _ = ask.value("getSystemState")
    assert (len(published), len(subscribed)) == (5001, 5001)


def test_invented_nodes_and_registrations_have_a_bound_and_what_is_there_goes_on(ask, monkeypatch):
    monkeypatch.setattr(registrations, "MAX_NODES", 3)
    monkeypatch.setattr(registrations, "MAX_REGISTRATIONS", 5)
    for node in range(3):
        assert ask("registerSubscriber", f"/n{node}", "/chat", STRING, f"http://h:{node}/").status == 1
    refused = ask("registerSubscriber", "/n3", "/chat", STRING, "http://h:3/")
    assert (refused.status, refused.value) == (-1, []) and "3 nodes" in refused.message
    assert ask("registerPublisher", "/n0", "/chat", STRING, "http://h:0/").status == 1
    assert ask("registerService", "/n0", "/serve", "rosrpc://h:0", "http://h:0/").status == 1
    assert "5 registrations" in ask("subscribeParam", "/n0", "http://h:0/", "/p").message
    assert ask("registerPublisher", "/n0", "/chat", STRING, "http://h:0/").status == 1  # once more
    assert ask("registerSubscriber", "/n0", "/new", STRING, "http://h:9/").status == 1  # replaces all that /n0 had
    assert ask.value("getSystemState") == [[], [["/chat", ["/n1", "/n2"]], ["/new", ["/n0"]]], []]
    assert ask("unregisterSubscriber", "/n2", "/chat", "http://h:2/").value == 1
    for topic in ("/a", "/b", "/c"):
        assert ask("registerPublisher", "/n1", topic, STRING, "http://h:1/").status == 1
    assert ask("registerPublisher", "/n1", "/d", STRING, "http://h:1/").status == -1


def test_types_of_topics_that_are_gone_are_forgotten_in_the_end(ask, monkeypatch):
    monkeypatch.setattr(master_module, "_MAX_TYPES", 3)
    for topic in ("/kept", "/a", "/b", "/c"):
        assert ask("registerPublisher", "/n", topic, STRING, TALKER).status == 1
        if topic != "/kept":
            assert ask("unregisterPublisher", "/n", topic, TALKER).value == 1
    assert ask.value("getTopicTypes") == [["/kept", STRING], ["/c", STRING]]


@pytest.mark.parametrize(
    ("method", "params"),
    [
        ("registerPublisher", ["/" + "a" * 2000, STRING, TALKER]),
        ("registerPublisher", ["/a", "a/" + "b" * 2000, TALKER]),
        ("registerSubscriber", ["/a", STRING, TALKER + "a" * 2000]),
        ("registerService", ["/a", "rosrpc://" + "h" * 2000, TALKER]),
        ("setParam", ["/" + "a" * 2000, 1]),
        ("searchParam", ["a/" * 1000]),
        ("getPublishedTopics", ["/" + "a" * 2000]),
    ],
)
def test_names_have_a_longest_length(ask, method, params):
    refused = ask(method, "/test", *params)
    assert refused.status == -1 and "longer than" in refused.message
    assert "longer than 1024" in ask(method, "/" + "a" * 2000, "/a").message


def test_parameters_have_a_bound_that_the_caller_is_told(ask):
    assert ask("setParam", "/test", "/a", "x" * 8_000_000).status == 1
    refused = ask("setParam", "/test", "/b", "x" * 8_000_000)
    assert refused.status == -1 and "characters" in refused.message
    assert ask("setParam", "/test", "/a", 1).status == 1
    assert ask("setParam", "/test", "/b", "x" * 8_000_000).status == 1


names = st.text("ab/~: ", max_size=6) | st.sampled_from(["/a", "http://h:1/", "a/B", "*"])
values = st.recursive(
    st.none() | st.booleans() | st.integers(-9, 9) | st.binary(max_size=2) | names,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=3),
    max_leaves=6,
)
calls = st.tuples(st.sampled_from(sorted(METHODS)), st.lists(names | values, max_size=4))


@given(st.lists(calls, max_size=30))
def test_whatever_is_called_gets_a_reply_that_can_be_sent(sequence):
    master = Master("http://localhost:11311/", 17)
    for method, params in sequence:
        reply, _ = master.handle(MethodCall(method, params))
        assert reply.status in {-1, 0, 1}
        assert encode_response(reply.as_value())
