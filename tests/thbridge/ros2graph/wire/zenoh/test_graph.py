"""The graph that others announce: it counts what is there, and hostile announcements never fill the memory."""

from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2.qos import QosProfile
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.ros2graph.wire.zenoh.graph import MOST_KEYS, UNANNOUNCED, AnnouncedGraph
from thbridge.ros2graph.wire.zenoh.keys import SessionKeys

HASH = "RIHS01_" + "0" * 64
TYPE = "std_msgs::msg::dds_::String_"
NODES = [NodeName("/robot1", "amcl"), NodeName("/", "map_server")]
TOPICS = ["/map", "/robot1/scan"]


def endpoint(session="a", number=1, node=NODES[0], role=EndpointRole.PUBLISHER, topic=TOPICS[0]):
    return SessionKeys(0, session).endpoint(1, number, node, role, topic, TYPE, HASH, QosProfile())


def test_nodes_and_endpoints_come_and_go():
    graph = AnnouncedGraph("own")
    keys = endpoint()
    node = SessionKeys(0, "a").node(9, NODES[0])
    assert graph.add(node) and graph.add(keys.liveliness)
    assert graph.nodes() == [NODES[0]]
    assert [each.name for each in graph.endpoints()] == ["/map"]
    assert graph.node_of(keys.gid) == "/robot1/amcl"
    assert graph.count(EndpointRole.PUBLISHER, keys.data) == 1
    assert graph.count(EndpointRole.SUBSCRIPTION, keys.data) == 0
    graph.remove(keys.liveliness)
    graph.remove(node)
    assert (graph.nodes(), graph.endpoints(), graph.count(EndpointRole.PUBLISHER, keys.data)) == ([], [], 0)
    assert graph.node_of(keys.gid) == UNANNOUNCED


def test_own_announcements_are_not_part_of_the_graph():
    graph = AnnouncedGraph("own")
    assert graph.add(endpoint("own").liveliness)
    assert graph.endpoints() == []


@given(st.lists(st.tuples(st.booleans(), st.integers(1, 3), st.sampled_from(NODES), st.sampled_from(TOPICS))))
def test_the_graph_is_what_the_last_announcements_say(changes):
    graph, model = AnnouncedGraph("own"), {}
    for comes, number, node, topic in changes:
        keys = endpoint(number=number, node=node, topic=topic)
        if comes:
            assert graph.add(keys.liveliness)
            model[keys.liveliness] = keys
        else:
            graph.remove(keys.liveliness)
            model.pop(keys.liveliness, None)
    assert {each.gid for each in graph.endpoints()} == {keys.gid for keys in model.values()}
    for keys in model.values():
        same = sum(each.data == keys.data for each in model.values())
        assert graph.count(EndpointRole.PUBLISHER, keys.data) == same


def test_a_flood_of_announcements_is_cut_off_and_room_is_used_again():
    graph = AnnouncedGraph("own")
    keys = [SessionKeys(0, "a").node(number, NODES[0]) for number in range(MOST_KEYS + 1)]
    assert [graph.add(key) for key in keys].count(False) == 1
    assert not graph.add("@ros2_lv/hostile")
    graph.remove(keys[0])
    assert graph.add(keys[-1])
